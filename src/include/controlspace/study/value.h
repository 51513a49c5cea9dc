// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <variant>
#include <vector>

namespace controlspace {

/// A number or a text, as in an option or a study file.
struct Value : std::variant<double, std::string> {
    using std::variant<double, std::string>::variant;
    Value(int number) : variant(static_cast<double>(number)) {}
    Value(const char* text) : variant(std::string(text)) {}

    double number() const { return std::get<double>(*this); }
    const std::string& text() const { return std::get<std::string>(*this); }
};
using Values = std::vector<Value>;

/// The values of a flag are the texts "true" and "false".
enum class ValueType { number, whole_number, text, flag };

/// "1, 0.5".
std::string to_string(const Values& values);

/// Throws InputError unless `values` are of the type, and from 1 to `at_most` (0: any number).
void require_fit(ValueType type, std::size_t at_most, const Values& values);

}  // namespace controlspace
