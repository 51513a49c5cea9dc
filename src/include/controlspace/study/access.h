// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <concepts>
#include <filesystem>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "controlspace/error.h"
#include "controlspace/geometry/point.h"
#include "controlspace/study/value.h"
#include "controlspace/words.h"

namespace controlspace {

/// A permitted value of a text parameter, and its meaning.
struct Choice {
    std::string name;
    std::string meaning;
};

/// How a parameter is stored in a Target: its type, and both directions.
template <class Target>
struct Access {
    ValueType type = ValueType::number;
    std::size_t at_most = 1;  ///< values; 0: any number
    std::vector<Choice> choices = {};
    /// Precondition: the values are of the type and number. Throws InputError for other reasons.
    std::function<void(Target&, const Values&)> set;
    /// No values where there is none.
    std::function<Values(const Target&)> get;
};

/// Throws InputError for values that do not fit.
template <class Target>
void set_checked(const Access<Target>& access, Target& target, const Values& values) {
    require_fit(access.type, access.at_most, values);
    access.set(target, values);
}

/// Checks a number: returns it, or throws InputError.
using Check = std::function<double(double)>;
Check within(double least, double most);
inline Check at_least(double least) { return within(least, std::numeric_limits<double>::max()); }
double positive(double number);
inline double any_number(double number) { return number; }

/// Whether 0 stands for "none".
enum class Zero { is_a_number, is_none };

/// Throws InputError for a word that is not one of `choices`.
void require_choice(const std::string& word, const std::vector<Choice>& choices);

namespace detail {
template <class T>
struct Plain {
    using type = T;
};
template <class T>
struct Plain<std::optional<T>> {
    using type = T;
};
template <class T>
constexpr bool is_optional = !std::same_as<typename Plain<T>::type, T>;
/// Type of the member that `place` returns a reference to.
template <class Target, class Place>
using Member = std::remove_reference_t<std::invoke_result_t<Place, Target&>>;
}  // namespace detail

/// The number at `place`: &Case::tau, or `[](auto& c) -> auto& { return c.sources.rho; }`.
template <class Target, class Place>
Access<Target> number(Place place, const Check& check = any_number, Zero zero = Zero::is_a_number) {
    using Stored = detail::Member<Target, Place>;
    using Number = typename detail::Plain<Stored>::type;
    Access<Target> access;
    access.type = std::integral<Number> ? ValueType::whole_number : ValueType::number;
    access.set = [=](Target& target, const Values& values) {
        const double x = values.front().number();
        if (zero == Zero::is_none && x == 0) {
            std::invoke(place, target) = Stored{};
        } else {
            std::invoke(place, target) = static_cast<Number>(check(x));
        }
    };
    access.get = [=](const Target& target) -> Values {
        const Stored& stored = std::invoke(place, target);
        if constexpr (detail::is_optional<Stored>) {
            return stored ? Values{Value(static_cast<double>(*stored))} : Values{};
        } else {
            const auto x = static_cast<double>(stored);
            return zero == Zero::is_none && x == 0 ? Values{} : Values{Value(x)};
        }
    };
    return access;
}

/// A value of the enumeration at `place`, by its word.
template <class Target, class Place>
Access<Target> word(Place place) {
    using Stored = detail::Member<Target, Place>;
    using Enum = typename detail::Plain<Stored>::type;
    Access<Target> access;
    access.type = ValueType::text;
    for (const Word<Enum>& w : Words<Enum>::table) {
        access.choices.push_back({std::string(w.name), std::string(w.meaning)});
    }
    access.set = [place, choices = access.choices](Target& target, const Values& values) {
        require_choice(values.front().text(), choices);
        std::invoke(place, target) = *from_name<Enum>(values.front().text());
    };
    access.get = [place](const Target& target) -> Values {
        const std::optional<Enum> value = std::invoke(place, target);
        return value ? Values{std::string(name_of(*value))} : Values{};
    };
    return access;
}

/// The text or path at `place`; an empty one is none.
template <class Target, class Place>
Access<Target> text(Place place) {
    return {.type = ValueType::text,
            .set = [place](Target& target,
                           const Values& v) { std::invoke(place, target) = v.front().text(); },
            .get = [place](const Target& target) -> Values {
                const std::filesystem::path value = std::invoke(place, target);
                return value.empty() ? Values{} : Values{value.string()};
            }};
}

/// The bool at `place`; one that is false is none.
template <class Target, class Place>
Access<Target> flag(Place place) {
    return {
        .type = ValueType::flag,
        .set = [=](Target& target,
                   const Values& v) { std::invoke(place, target) = v.front().text() == "true"; },
        .get =
            [=](const Target& target) {
                return std::invoke(place, target) ? Values{"true"} : Values{};
            }};
}

/// The three coordinates at `place`.
template <class Target, class Place>
Access<Target> point(Place place) {
    return {.at_most = 3,
            .set =
                [place](Target& target, const Values& v) {
                    if (v.size() != 3) throw InputError("give three numbers: x y z");
                    std::invoke(place, target) = Point(v[0].number(), v[1].number(), v[2].number());
                },
            .get = [place](const Target& target) -> Values {
                const Point& p = std::invoke(place, target);
                return {p.x(), p.y(), p.z()};
            }};
}

}  // namespace controlspace
