// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>
#include <utility>
#include <vector>

#include "controlspace/space/number_kind.h"

namespace controlspace {

/// An array of any type: an entry for each leaf.
class LeafArray {
public:
    LeafArray(NumberKind kind, std::size_t entry_size) : kind_(kind), entry_size_(entry_size) {}
    virtual ~LeafArray() = default;

    NumberKind kind() const { return kind_; }
    std::size_t entry_size() const { return entry_size_; }  ///< bytes

    virtual std::size_t size() const = 0;
    virtual std::size_t capacity() const = 0;
    virtual const void* data() const = 0;
    /// Empty, with room for so many.
    virtual void clear(std::size_t room) = 0;
    virtual void append(const void* entries, std::size_t count) = 0;
    /// Entry i becomes what entry former[i] was.
    virtual void reorder(const std::vector<std::uint32_t>& former) = 0;
    virtual void shrink_to_fit() = 0;

private:
    NumberKind kind_;
    std::size_t entry_size_;
};

template <class T>
class LeafArrayOf final : public LeafArray {
public:
    explicit LeafArrayOf(std::vector<T>& values)
        : LeafArray(number_kind<T>(), sizeof(T)), values_(values) {}

    std::size_t size() const override { return values_.size(); }
    std::size_t capacity() const override { return values_.capacity(); }
    const void* data() const override { return values_.data(); }
    void clear(std::size_t room) override {
        values_ = {};
        values_.reserve(room);
    }
    void append(const void* entries, std::size_t count) override {
        const T* const first = static_cast<const T*>(entries);
        values_.insert(values_.end(), first, first + count);
    }
    void reorder(const std::vector<std::uint32_t>& former) override {
        std::vector<T> ordered;
        ordered.reserve(former.size());
        for (const std::uint32_t leaf : former) ordered.push_back(values_[leaf]);
        values_ = std::move(ordered);
    }
    void shrink_to_fit() override { values_.shrink_to_fit(); }

private:
    std::vector<T>& values_;
};

/// Visits what the leaves of a tree hold beside metrics (CellModel::arrays): arrays with an entry
/// for each leaf, of double, Point, Box, Metric, std::uint32_t or std::array of one of them; and
/// single numbers.
class LeafArrays {
public:
    virtual ~LeafArrays() = default;

    template <class T>
    void operator()(std::string_view name, std::vector<T>& values) {
        LeafArrayOf<T> array(values);
        visit(name, array);
    }
    void operator()(std::string_view name, double& number) { visit(name, number); }

protected:
    virtual void visit(std::string_view name, LeafArray& array) = 0;
    virtual void visit(std::string_view name, double& number) = 0;
};

}  // namespace controlspace
