// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <catch2/catch.hpp>
#include <iterator>
#include <string>
#include <type_traits>

#include "controlspace/space/catalogue.h"

// CASE_OF_EACH(entry, tree_catalogue(), "what holds") { ... entry ... } is a test case for each
// item of the range, called after it: "what holds - K_L", "what holds - K_V", and so on. Each is
// listed, run and failed by itself. Another argument gives Catch2's tags.

namespace controlspace {

inline std::string case_name(const CatalogueEntry& entry) { return entry.id; }

template <class Item>
class CasesOfEach {
public:
    using Body = void (*)(const Item&);

    template <class Range>
    CasesOfEach(Body body, const Catch::SourceLineInfo& line, const Range& items,
                const std::string& what, const std::string& tags = "") {
        for (const Item& item : items) {
            const std::string name = what + " - " + case_name(item);
            Catch::AutoReg(new Case(body, item), line, Catch::StringRef(), {name, tags});
        }
    }

private:
    class Case final : public Catch::ITestInvoker {
    public:
        Case(Body body, const Item& item) : body_(body), item_(item) {}
        void invoke() const override { body_(item_); }

    private:
        Body body_;
        Item item_;
    };
};

template <class Range>
using ItemOf = std::remove_cvref_t<decltype(*std::begin(std::declval<const Range&>()))>;

}  // namespace controlspace

#define CASE_OF_EACH_AS(body, cases, item, items, ...)                                   \
    static void body(const controlspace::ItemOf<decltype(items)>&);                      \
    static const controlspace::CasesOfEach<controlspace::ItemOf<decltype(items)>> cases( \
        &body, CATCH_INTERNAL_LINEINFO, items, __VA_ARGS__);                             \
    static void body(const controlspace::ItemOf<decltype(items)>& item)

#define CASE_OF_EACH(item, items, ...)                                                           \
    CASE_OF_EACH_AS(INTERNAL_CATCH_UNIQUE_NAME(body_of_), INTERNAL_CATCH_UNIQUE_NAME(cases_of_), \
                    item, items, __VA_ARGS__)
