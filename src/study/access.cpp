// SPDX-License-Identifier: Apache-2.0
#include "controlspace/study/access.h"

#include <fmt/format.h>

#include <cmath>

#include "refuse.h"

namespace controlspace {
namespace {

void require_type(ValueType type, const Value& value) {
    const double* x = std::get_if<double>(&value);
    if (type == ValueType::flag) {
        if (value != Value("true") && value != Value("false")) {
            refuse("{} is neither true nor false", to_string({value}));
        }
        return;
    }
    if (type == ValueType::text) {
        if (x != nullptr) refuse("{} is not a text", *x);
        return;
    }
    if (x == nullptr) refuse("'{}' is not a number", value.text());
    if (!std::isfinite(*x)) refuse("{} is not a finite number", *x);
    if (type == ValueType::whole_number && *x != std::floor(*x)) {
        refuse("{} is not a whole number", *x);
    }
}

}  // namespace

std::string to_string(const Values& values) {
    std::string text;
    for (const Value& value : values) {
        if (!text.empty()) text += ", ";
        text += std::visit([](const auto& v) { return fmt::format("{}", v); }, value);
    }
    return text;
}

void require_fit(ValueType type, std::size_t at_most, const Values& values) {
    if (values.empty()) refuse("no value: give at least one");
    if (at_most > 0 && values.size() > at_most) {
        refuse("{} values: give {} at most", values.size(), at_most);
    }
    for (const Value& value : values) require_type(type, value);
}

Check within(double least, double most) {
    return [=](double number) {
        if (number < least || number > most) {
            refuse("{} is out of range: give {} to {}", number, least, most);
        }
        return number;
    };
}

double positive(double number) {
    if (!(number > 0)) refuse("{} is not positive", number);
    return number;
}

void require_choice(const std::string& word, const std::vector<Choice>& choices) {
    std::string known;
    for (const Choice& choice : choices) {
        if (choice.name == word) return;
        known += (known.empty() ? "" : ", ") + choice.name;
    }
    refuse("unknown value '{}': give {}", word, known);
}

}  // namespace controlspace
