// SPDX-License-Identifier: Apache-2.0
// K_oL of the paper's tables with right links between leaves and with those of the published
// program, at all six settings of the paper's sphere: prints data/paper/octree_links.csv, which
// bench/links makes by it. Sources are isotropic, so that a metric is one length. It uses nothing
// of the library, whose trees it confirms.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <initializer_list>
#include <numbers>
#include <vector>

namespace {

using Point = std::array<double, 3>;
constexpr int none = -1;
constexpr int faces = 6;  // 2 axis for the low face, 2 axis + 1 for the high one
constexpr double ratio = 1.25;
constexpr double length_of_sources = 0.03;
const double largest_length = std::sqrt(3.0);

struct Element {
    Point middle;
    double half;
    int level;
    double length;
    int first_child = none;
    std::array<int, faces> across{none, none, none, none, none, none};
};

double nonconformity(double a, double b) { return std::sqrt(3.0) * (a / b + b / a - 2); }

class Octree {
public:
    explicit Octree(bool as_published) : as_published_(as_published) {
        elements_.push_back({{0, 0, 0}, 1, 0, largest_length});
    }

    const std::vector<Element>& elements() const { return elements_; }
    const Element& operator[](int i) const { return elements_[static_cast<std::size_t>(i)]; }
    Element& operator[](int i) { return elements_[static_cast<std::size_t>(i)]; }

    /// The leaf in `i` at `x`, or nearest to it.
    int leaf_in(int i, const Point& x) const {
        while ((*this)[i].first_child != none) i = child_at(i, x);
        return i;
    }

    void insert(const Point& x, double longest_edge) {
        constexpr double tolerance = 0.2;
        constexpr int deepest = 14;
        int leaf = leaf_in(0, x);
        if (nonconformity(length_of_sources, (*this)[leaf].length) < tolerance) return;
        while ((*this)[leaf].level < deepest &&
               2 * (*this)[leaf].half / length_of_sources > longest_edge) {
            split(leaf);
            leaf = child_at(leaf, x);
        }
        (*this)[leaf].length = std::min((*this)[leaf].length, length_of_sources);
    }

    std::vector<int> leaves() const {
        std::vector<int> found, rest{0};
        while (!rest.empty()) {
            const int i = rest.back();
            rest.pop_back();
            if ((*this)[i].first_child == none) {
                found.push_back(i);
            } else {
                for (int c = 7; c >= 0; --c) rest.push_back((*this)[i].first_child + c);
            }
        }
        return found;
    }

private:
    int child_at(int i, const Point& x) const {
        const Element& e = (*this)[i];
        int child = e.first_child;
        for (int a = 0; a < 3; ++a) child += x[a] > e.middle[a] ? 1 << a : 0;
        return child;
    }

    void split(int i) {
        const int first = static_cast<int>(elements_.size());
        (*this)[i].first_child = first;
        for (int c = 0; c < 8; ++c) {
            const Element parent = (*this)[i];
            Element child{parent.middle, parent.half / 2, parent.level + 1, parent.length};
            for (int a = 0; a < 3; ++a) child.middle[a] += (c >> a & 1) ? child.half : -child.half;
            for (int face = 0; face < faces; ++face) {
                const int axis = face / 2;
                const int mirrored = c ^ 1 << axis;
                const bool inside = (c >> axis & 1) != face % 2;
                child.across[face] =
                    inside ? first + mirrored : neighbour(parent.across[face], child, mirrored);
            }
            elements_.push_back(child);
        }
        if (as_published_) link_back(i, first);
    }

    // By its number, which is right only if the parent's neighbour is as large as the parent; or by
    // place.
    int neighbour(int of_parent, const Element& child, int mirrored) const {
        if (of_parent == none || (*this)[of_parent].first_child == none) return of_parent;
        if (as_published_) return (*this)[of_parent].first_child + mirrored;
        int i = of_parent;
        while ((*this)[i].first_child != none && (*this)[i].level < child.level)
            i = child_at(i, child.middle);
        return i;
    }

    // Neighbours found by their number link back to the child, whether they touch it or not.
    void link_back(int parent, int first) {
        for (int c = 0; c < 8; ++c) {
            for (int face = 0; face < faces; ++face) {
                const bool inside = (c >> face / 2 & 1) != face % 2;
                const int found = (*this)[first + c].across[face];
                if (inside || found == (*this)[parent].across[face]) continue;
                (*this)[found].across[face ^ 1] = first + c;
            }
        }
    }

    bool as_published_;
    std::vector<Element> elements_;
};

/// Returns the number of sources.
int insert_sphere(Octree& tree, double density, double longest_edge) {
    constexpr double radius = 0.8;
    const double quarter = std::numbers::pi / 2;
    const double a = quarter * radius / (0.015 * density);
    int count = 0;
    const auto insert = [&](double x, double y, double z) {
        tree.insert({radius * x, radius * y, radius * z}, longest_edge);
        ++count;
    };
    const auto insert_four = [&](double sine, double cosine, double z) {
        for (const double x : {sine, -sine}) {
            for (const double y : {cosine, -cosine}) insert(x, y, z);
        }
    };
    const int n = 1 + static_cast<int>(a);
    const double latitude = quarter / n;
    for (int j = 0; j < n; ++j) insert_four(std::sin(j * latitude), std::cos(j * latitude), 0);
    for (int i = 1; i < n; ++i) {
        const double c = std::cos(i * latitude), z = std::sin(i * latitude);
        const int m = 1 + static_cast<int>(c * a);
        const double step = quarter / m;
        for (int j = 0; j < m; ++j) {
            insert_four(c * std::sin(j * step), c * std::cos(j * step), z);
            insert_four(c * std::sin(j * step), c * std::cos(j * step), -z);
        }
    }
    insert(0, 0, 1);
    insert(0, 0, -1);
    return count;
}

bool touch(const Element& a, const Element& b, int face) {
    for (int axis = 0; axis < 3; ++axis) {
        const double gap = std::abs(a.middle[axis] - b.middle[axis]) - a.half - b.half;
        if (axis == face / 2 ? gap > 1e-12 : gap > -1e-12) return false;
    }
    return true;
}

/// Follows each link to the leaf nearest to the middle of its own leaf. Returns the share of links
/// to leaves that do not touch.
double finish_links(Octree& tree, const std::vector<int>& leaves) {
    double links = 0, wrong = 0;
    for (const int leaf : leaves) {
        for (int face = 0; face < faces; ++face) {
            int& across = tree[leaf].across[face];
            if (across == none) continue;
            across = tree.leaf_in(across, tree[leaf].middle);
            ++links;
            wrong += touch(tree[leaf], tree[across], face) ? 0 : 1;
        }
    }
    return wrong / links;
}

double metric_distance(const Element& a, const Element& b) {
    const double distance =
        std::hypot(a.middle[0] - b.middle[0], a.middle[1] - b.middle[1], a.middle[2] - b.middle[2]);
    return (distance / a.length + distance / b.length) / 2;
}

/// At most ten passes of the mean-length law over the active leaves.
void grade(Octree& tree, const std::vector<int>& leaves) {
    std::vector<int> active = leaves;
    for (int pass = 0; pass < 10; ++pass) {
        bool changed = false;
        const auto limit = [&](Element& e, double allowed, double by) {
            if (e.length <= allowed * by) return;
            e.length = allowed * by;
            changed = true;
        };
        for (const int leaf : active) {
            Element& own = tree[leaf];
            std::array<double, faces> allowed{};
            bool alike = true;
            std::vector<int> linked;
            for (int face = 0; face < faces; ++face) {
                if (own.across[face] != none) linked.push_back(face);
            }
            for (const int face : linked) {
                const Element& other = tree[own.across[face]];
                allowed[face] = 1 + (ratio - 1) * metric_distance(own, other);
                alike = alike && nonconformity(own.length, other.length) < 0.01;
            }
            if (alike) continue;
            const double before = own.length;
            for (const int face : linked) {
                if (before > allowed[face] * tree[own.across[face]].length) {
                    limit(own, allowed[face], tree[own.across[face]].length);
                }
            }
            for (const int face : linked) {
                Element& other = tree[own.across[face]];
                limit(other, 1 + (ratio - 1) * metric_distance(own, other), own.length);
            }
        }
        if (!changed) return;
        active.clear();
        for (const int leaf : leaves) {
            const Element& own = tree[leaf];
            const bool steep = std::any_of(own.across.begin(), own.across.end(), [&](int across) {
                if (across == none) return false;
                const double k = own.length / tree[across].length;
                return 1 + (std::max(k, 1 / k) - 1) / metric_distance(own, tree[across]) >
                       1.05 * ratio;
            });
            if (steep) active.push_back(leaf);
        }
    }
}

struct Errors {
    double largest = 0, mean = 0;
};

Errors errors(const Octree& tree) {
    constexpr int n = 30;
    const auto at = [](int i) { return -1 + 1.0 / n + 2.0 * i / n; };
    const double slope = 2 * (ratio - 1) / (ratio + 1);
    Errors found;
    for (int i = 0; i < n * n * n; ++i) {
        const Point x{at(i / n / n), at(i / n % n), at(i % n)};
        const double distance = std::abs(std::hypot(x[0], x[1], x[2]) - 0.8);
        const double reference = std::min(largest_length, length_of_sources + slope * distance);
        const double delta = nonconformity(reference, tree[tree.leaf_in(0, x)].length);
        found.largest = std::max(found.largest, delta);
        found.mean += delta / (n * n * n);
    }
    return found;
}

}  // namespace

int main() {
    std::puts(
        "# K_oL on the paper's sphere, graded as for the paper's tables, with right links and with "
        "links as in the\n"
        "# published program: when an element splits, its children take the children of a "
        "neighbour that has split by\n"
        "# their number, even of a coarser one, and these link back to them. wrong_links: share of "
        "links between leaves\n"
        "# that do not touch. Made by bench/links.\n"
        "rho,tau,links,sources,elements,leaves,wrong_links,delta_R_max,delta_R_mean");
    for (const double rho : {1.0, 0.2}) {
        for (const double tau : {1.0, 0.5, 0.2}) {
            for (const bool as_published : {false, true}) {
                Octree tree(as_published);
                const int sources = insert_sphere(tree, rho, tau);
                const std::vector<int> leaves = tree.leaves();
                const double wrong = finish_links(tree, leaves);
                grade(tree, leaves);
                const Errors delta = errors(tree);
                std::printf("%g,%g,%s,%d,%zu,%zu,%.4f,%.4f,%.4f\n", rho, tau,
                            as_published ? "published" : "right", sources, tree.elements().size(),
                            leaves.size(), wrong, delta.largest, delta.mean);
            }
        }
    }
}
