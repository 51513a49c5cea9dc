// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gmsh.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "controlspace/geometry/point.h"

namespace controlspace {

/// The nodes of Gmsh's mesh, numbered from 0.
class GmshNodes {
public:
    GmshNodes() {
        std::vector<std::size_t> tags;
        std::vector<double> x, unused;
        gmsh::model::mesh::getNodes(tags, x, unused);
        for (std::size_t i = 0; i < tags.size(); ++i) {
            if (tags[i] >= number_of_tag_.size()) number_of_tag_.resize(tags[i] + 1);
            number_of_tag_[tags[i]] = static_cast<std::uint32_t>(i);
            places_.emplace_back(x[3 * i], x[3 * i + 1], x[3 * i + 2]);
        }
    }

    const std::vector<Point>& places() const { return places_; }
    std::uint32_t number(std::size_t tag) const { return number_of_tag_[tag]; }

    /// The elements of one of Gmsh's types, of `n` nodes each; those of one entity, or of all.
    template <std::size_t n>
    std::vector<std::array<std::uint32_t, n>> elements(int type, int entity = -1) const {
        std::vector<std::size_t> tags, nodes;
        gmsh::model::mesh::getElementsByType(type, tags, nodes, entity);
        std::vector<std::array<std::uint32_t, n>> result(nodes.size() / n);
        for (std::size_t i = 0; i < nodes.size(); ++i) {
            result[i / n][i % n] = number(nodes[i]);
        }
        return result;
    }

    static constexpr int triangle = 2, tetrahedron = 4;  // Gmsh's types

private:
    std::vector<Point> places_;
    std::vector<std::uint32_t> number_of_tag_;
};

}  // namespace controlspace
