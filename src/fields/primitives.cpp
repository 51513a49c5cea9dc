// SPDX-License-Identifier: Apache-2.0
#include "controlspace/fields/primitives.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <set>
#include <span>
#include <utility>

#include "controlspace/fields/formula_field.h"
#include "controlspace/sources/point_source.h"
#include "files/text_file.h"
#include "refuse.h"

namespace controlspace {
namespace {

struct ShapeSyntax {
    Shape shape;
    std::string_view name;
    std::size_t numbers;
    std::string_view form;  ///< without the name
    bool has_radius;
};
constexpr std::array<ShapeSyntax, 5> shapes{{
    {Shape::box, "box", 6, "x0,x1,y0,y1,z0,z1,h=0.02", false},
    {Shape::ball, "ball", 3, "x,y,z,r=0.1,h=0.02", true},
    {Shape::cylinder, "cylinder", 6, "x0,y0,z0,x1,y1,z1,r=0.1,h=0.02", true},
    {Shape::segment, "segment", 6, "x0,y0,z0,x1,y1,z1,h=0.02", false},
    {Shape::surface, "surface", 0, "part.stl,h=0.02", false},
}};

const ShapeSyntax* syntax_of(std::string_view text) {
    const std::string_view name = text.substr(0, text.find(':'));
    const auto* found = std::ranges::find(shapes, name, &ShapeSyntax::name);
    return name.size() == text.size() || found == shapes.end() ? nullptr : found;
}
const ShapeSyntax& syntax_of(Shape shape) {
    return *std::ranges::find(shapes, shape, &ShapeSyntax::shape);
}

/// Reads one primitive; what is wrong is said with its text.
class Parser {
public:
    explicit Parser(std::string_view text) : text_(text), syntax_(syntax_of(text)) {}

    Primitive primitive() {
        if (syntax_ == nullptr) fail("begin with box:, ball:, cylinder:, segment: or surface:");
        made_.shape = syntax_->shape;
        for (const auto word : split(text_.substr(syntax_->name.size() + 1), ',')) add(word);
        finish();
        return made_;
    }

private:
    template <class... Args>
    [[noreturn]] void fail(fmt::format_string<Args...> text, Args&&... args) const {
        refuse_at(text_, text, std::forward<Args>(args)...);
    }
    [[noreturn]] void fail_with_form(const std::string& what) const {
        fail("{}: write {}:{}", what, syntax_->name, syntax_->form);
    }

    double number(std::string_view word) const {
        double x = 0;
        if (!parse_number(word, x)) fail("'{}' is no number", word);
        return x;
    }

    void add(std::string_view word) {
        const std::size_t equals = word.find('=');
        if (made_.shape == Shape::surface && !std::exchange(has_file_, true)) {
            made_.file = word;
        } else if (equals != word.npos) {
            set(word.substr(0, equals), number(word.substr(equals + 1)));
        } else {
            numbers_.push_back(number(word));
        }
    }

    void set(std::string_view key, double value) {
        const bool is_radius = key == "r" && syntax_->has_radius;
        if (!is_radius && key != "h" && key != "g") {
            fail("unknown setting '{}': known are {}h and g", key,
                 syntax_->has_radius ? "r, " : "");
        }
        if (!given_.insert(key).second) fail("{} is given twice", key);
        if (key == "g") {
            if (!(value >= 1 && value <= steepest_primitive)) {
                fail("g is {}: give a gradation ratio from 1 to 5", value);
            }
            made_.ratio = value;
            return;
        }
        if (!is_length(value)) fail("{} is {}: give a positive length", key, value);
        (key == "r" ? made_.radius : made_.h) = value;
    }

    void finish() {
        if (numbers_.size() != syntax_->numbers) {
            fail_with_form(made_.shape == Shape::surface
                               ? "a file and its settings are enough"
                               : fmt::format("{} coordinates, but {} are needed", numbers_.size(),
                                             syntax_->numbers));
        }
        if (made_.shape == Shape::surface && made_.file.empty()) fail_with_form("no file is named");
        if (syntax_->has_radius && !given_.contains("r")) fail_with_form("the radius r is missing");
        if (!given_.contains("h")) fail_with_form("the length h is missing");
        for (const double x : numbers_) {
            if (!is_coordinate(x)) fail("{} is no coordinate: give finite ones", x);
        }
        if (made_.shape == Shape::box) {
            made_.a = {numbers_[0], numbers_[2], numbers_[4]};
            made_.b = {numbers_[1], numbers_[3], numbers_[5]};
            for (int axis = 0; axis < 3; ++axis) {
                if (made_.a[axis] < made_.b[axis]) continue;
                fail("{0}0 is {1} and {0}1 is {2}: give {0}0 < {0}1", "xyz"[axis], made_.a[axis],
                     made_.b[axis]);
            }
            return;
        }
        if (numbers_.size() >= 3) made_.a = {numbers_[0], numbers_[1], numbers_[2]};
        if (numbers_.size() == 6) {
            made_.b = {numbers_[3], numbers_[4], numbers_[5]};
            if (made_.a == made_.b) fail("both ends are at the same place: give different ones");
        }
    }

    std::string_view text_;
    const ShapeSyntax* syntax_;
    Primitive made_;
    std::vector<double> numbers_;
    std::set<std::string_view> given_;  ///< keys
    bool has_file_ = false;
};

/// A line from a to b: places by how far along it they are, and how far beside.
struct Axis3 {
    Point a;
    Vector along;  ///< unit vector
    double length;

    Axis3(const Point& from, const Point& to)
        : a(from), along((to - from).normalized()), length((to - from).norm()) {}

    double distance(const Point& p, double radius) const {
        const double t = along.dot(p - a);
        const double beside = std::max(0.0, (p - a - t * along).norm() - radius);
        return std::hypot(std::max({0.0, -t, t - length}), beside);
    }
};

/// The box around discs of that radius normal to the line at both ends.
Box box_around(const Point& a, const Point& b, double radius) {
    const Vector n = (b - a).normalized();
    const Vector reach = radius * (Vector::Ones() - n.cwiseProduct(n)).cwiseMax(0).cwiseSqrt();
    return {a.cwiseMin(b) - reach, a.cwiseMax(b) + reach};
}

/// Points n[0] x n[1] x n[2] in the box, ends included, about h apart, but not too many.
std::vector<Point> places_in(const Box& box, double h, double most) {
    const Eigen::Array3i n =
        1 + (box.edges() / h).array().ceil().cwiseMax(2).cwiseMin(most).cast<int>();
    std::vector<Point> places;
    for (int i = 0; i < n[0]; ++i) {
        for (int j = 0; j < n[1]; ++j) {
            for (int k = 0; k < n[2]; ++k) {
                const Vector part = Eigen::Array3d(i, j, k) / (n - 1).cast<double>();
                places.push_back(box.low + part.cwiseProduct(box.edges()));
            }
        }
    }
    return places;
}

std::vector<Point> places_on(const Point& a, const Point& b, double h) {
    const int n = static_cast<int>(std::clamp(std::ceil((b - a).norm() / h), 2.0, 1000.0));
    std::vector<Point> places;
    for (int i = 0; i <= n; ++i) places.push_back(a + double(i) / n * (b - a));
    return places;
}

struct Law {
    double h, slope;
    std::function<double(const Point&)> distance;
};

}  // namespace

bool is_primitive(std::string_view text) { return syntax_of(text) != nullptr; }

Primitive parse_primitive(std::string_view text) { return Parser(text).primitive(); }

std::string to_string(const Primitive& p) {
    const ShapeSyntax& syntax = syntax_of(p.shape);
    std::array x{p.a.x(), p.a.y(), p.a.z(), p.b.x(), p.b.y(), p.b.z()};
    if (p.shape == Shape::box) x = {p.a.x(), p.b.x(), p.a.y(), p.b.y(), p.a.z(), p.b.z()};
    std::string text = fmt::format("{}:{}{}", syntax.name, p.file.string(),
                                   fmt::join(std::span(x).first(syntax.numbers), ","));
    if (syntax.has_radius) text += fmt::format(",r={}", p.radius);
    text += fmt::format(",h={}", p.h);
    if (p.ratio) text += fmt::format(",g={}", *p.ratio);
    return text;
}

DistanceField distance_from(const Primitive& p) {
    switch (p.shape) {
        case Shape::box: {
            const Box box{p.a, p.b};
            return {[box](const Point& x) { return (x - nearest_in(box, x)).norm(); }, box,
                    places_in(box, p.h, 10)};
        }
        case Shape::ball: {
            const Vector reach = Vector::Constant(p.radius);
            return {[c = p.a, r = p.radius](const Point& x) {
                        return std::max(0.0, (x - c).norm() - r);
                    },
                    {p.a - reach, p.a + reach},
                    {p.a}};
        }
        case Shape::cylinder:
        case Shape::segment:
            return {[axis = Axis3(p.a, p.b), r = p.radius](const Point& x) {
                        return axis.distance(x, r);
                    },
                    box_around(p.a, p.b, p.radius), places_on(p.a, p.b, p.h)};
        case Shape::surface:
            break;
    }
    throw std::invalid_argument("distance_from: a surface is in a file");
}

AnalyticField primitives_field(std::span<const Primitive> primitives,
                               std::vector<DistanceField> distances, double ratio) {
    assert(primitives.size() == distances.size());
    if (primitives.empty()) refuse("no primitives: give at least one");
    AnalyticField field;
    field.is_isotropic = true;
    field.finest_length = std::ranges::min(primitives, {}, &Primitive::h).h;
    std::vector<Law> laws;
    for (std::size_t i = 0; i < primitives.size(); ++i) {
        const double g = primitives[i].ratio.value_or(ratio);
        if (!(g >= 1 && g <= steepest_primitive)) {
            refuse("{} grows by g_r = {}: give a gradation ratio from 1 to {}",
                   to_string(primitives[i]), g, steepest_primitive);
        }
        require_length("h", primitives[i].h);
        laws.push_back({primitives[i].h, g - 1, std::move(distances[i].distance)});
        const std::vector<Point>& places = distances[i].places;
        field.places.insert(field.places.end(), places.begin(), places.end());
    }
    field.field = formula_field([laws = std::move(laws)](const Point& x) {
        double h = largest_magnitude;
        for (const Law& law : laws) h = std::min(h, law.h + law.slope * law.distance(x));
        return Metric::isotropic(h);
    });
    return field;
}

}  // namespace controlspace
