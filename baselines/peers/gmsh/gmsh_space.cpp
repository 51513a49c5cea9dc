// SPDX-License-Identifier: Apache-2.0
#include "baselines/peers/gmsh/gmsh_space.h"

#include <fmt/format.h>
#include <gmsh.h>
#include <malloc.h>

#include <algorithm>
#include <exception>
#include <mutex>

#include "baselines/peers/gmsh/gmsh_classes.h"
#include "controlspace/error.h"
#include "controlspace/sources/riemannian.h"
#include "refuse.h"

namespace controlspace {

namespace {

bool is_open(GModel* model) { return std::ranges::count(GModel::list, model) != 0; }

/// Leaves the model that was current so in the end.
class KeepsCurrent {
public:
    KeepsCurrent() : before_(GModel::current()) {}
    ~KeepsCurrent() {
        if (is_open(before_)) GModel::setCurrent(before_);
    }
    KeepsCurrent(const KeepsCurrent&) = delete;
    KeepsCurrent& operator=(const KeepsCurrent&) = delete;

private:
    GModel* before_;
};

std::mutex& only_gmsh() {
    static std::mutex mutex;
    return mutex;
}

/// Gmsh throws strings, and in places more.
void in_gmsh(const auto& action) {
    const std::lock_guard lock(only_gmsh());
    try {
        action();
    } catch (const std::string& what) {
        throw InputError("Gmsh failed: " + what);
    } catch (const std::exception&) {
        throw;
    } catch (...) {
        refuse("Gmsh failed");
    }
}

std::size_t allocated() {
    const auto counts = mallinfo2();
    return counts.uordblks + counts.hblkhd;
}

[[noreturn]] void throw_uncovered(const Point& x) {
    refuse("Gmsh's field has no size at ({} {} {}): leave it out of --structures", x.x(), x.y(),
           x.z());
}

double length(double size, const Point& x) {
    constexpr double nothing = 1e21;  // Gmsh's answer where there is no field is 1e22
    if (!(size > 0 && size < nothing)) throw_uncovered(x);
    return size;
}

}  // namespace

void open_gmsh() {
    in_gmsh([] {
        if (!GModel::list.empty()) return;
        gmsh::initialize(0, nullptr, false);  // not open, or closed again
        gmsh::option::setNumber("General.Terminal", 0);
    });
}

GmshSpace::GmshSpace(const Box& domain, const Footprint& counts, const std::function<Made()>& make)
    : domain_(domain), footprint_(counts) {
    open_gmsh();
    const std::size_t before = allocated();
    try {
        in_gmsh([&] {
            static int made = 0;
            const KeepsCurrent current;
            gmsh::model::add(fmt::format("controlspace {}", ++made));
            model_ = GModel::current();
            made_ = make();
            field_ = model_->getFields()->get(made_.field);
        });
        sample_at(*this, domain.centre());
    } catch (...) {
        remove();
        throw;
    }
    const std::size_t least = before + counts.bytes_payload;
    footprint_.bytes_topology = std::max(allocated(), least) - least;
}

GmshSpace::~GmshSpace() { remove(); }

void GmshSpace::remove() noexcept {
    try {
        in_gmsh([&] {
            if (!is_open(model_)) return;  // Gmsh was closed
            const KeepsCurrent current;
            GModel::setCurrent(model_);
            gmsh::model::remove();
            if (made_.view >= 0) gmsh::view::remove(made_.view);
        });
    } catch (...) {  // nothing is left to do
    }
}

void GmshSpace::for_each_inside(std::span<const Point> x, const auto& answer) const {
    in_gmsh([&] {
        if (!is_open(model_)) {
            refuse("Gmsh was closed, by a mesh that it made meanwhile: build the structure anew");
        }
        for (std::size_t i = 0; i < x.size(); ++i) {
            answer(i, nearest_in(domain_, x[i]));
        }
    });
}

void GmshSpace::sample(std::span<const Point> x, std::span<Metric> out) const {
    if (!made_.has_tensors) {
        std::vector<double> sizes(x.size());
        sample_lengths(x, sizes);
        std::ranges::transform(sizes, out.begin(), Metric::isotropic);
        return;
    }
    auto& field = *reinterpret_cast<PostViewField*>(field_);
    for_each_inside(x, [&](std::size_t i, const Point& p) {
        SMetric3 tensor;  // zeros where the view does not cover the place
        field(p.x(), p.y(), p.z(), tensor, nullptr);
        const auto& t = tensor.lower_triangle;
        const auto metric = from_riemannian({t[0], t[2], t[5], t[1], t[3], t[4]});
        if (!metric) throw_uncovered(p);
        out[i] = *metric;
    });
}

void GmshSpace::sample_lengths(std::span<const Point> x, std::span<double> out) const {
    if (made_.has_tensors) return ControlSpace::sample_lengths(x, out);
    const auto write = [&](auto& field) {
        for_each_inside(x, [&](std::size_t i, const Point& p) {
            out[i] = length(field(p.x(), p.y(), p.z(), nullptr), p);
        });
    };
    if (made_.view >= 0) {
        write(*reinterpret_cast<PostViewField*>(field_));
    } else {
        write(*reinterpret_cast<StructuredField*>(field_));
    }
}

void GmshSpace::save(StateWriter&) const {
    refuse(
        "a field of Gmsh is not saved: save tets-linear or uniform-trilinear, or export a .pos or "
        ".structured file");
}

std::vector<CatalogueEntry> gmsh_rows() { return {gmsh_view_row(), gmsh_structured_row()}; }

}  // namespace controlspace
