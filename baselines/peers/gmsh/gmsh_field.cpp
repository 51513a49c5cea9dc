#include "baselines/peers/gmsh/gmsh_field.h"

#include <fmt/format.h>
#include <gmsh.h>
#include <malloc.h>

#include <algorithm>
#include <mutex>
#include <vector>

#include "controlspace/error.h"

// Exported by Gmsh 4.8 to 4.13, but declared in no header that is installed.
class GEntity;
class GModel {
public:
    static std::vector<GModel*> list;
    static GModel* current(int index = -1);
    static int setCurrent(GModel* model);
    GRegion* getRegionByTag(int tag) const;
};
double BGM_MeshSizeWithoutScaling(GEntity* entity, double u, double v, double x, double y,
                                  double z);

namespace controlspace {

namespace {

/// Gmsh, for one thread at a time, with the model that was current as it was before.
class InGmsh {
public:
    InGmsh() : lock_(only()) {
        [[maybe_unused]] static const bool is_open = [] {
            gmsh::initialize(0, nullptr, false);
            gmsh::option::setNumber("General.Terminal", 0);
            return true;
        }();
        before_ = GModel::current();
    }
    ~InGmsh() {
        if (std::ranges::count(GModel::list, before_) != 0) GModel::setCurrent(before_);
    }
    InGmsh(const InGmsh&) = delete;
    InGmsh& operator=(const InGmsh&) = delete;

private:
    static std::mutex& only() {
        static std::mutex mutex;
        return mutex;
    }
    std::lock_guard<std::mutex> lock_;
    GModel* before_;
};

std::size_t allocated() {
    const auto counts = mallinfo2();
    return counts.uordblks + counts.hblkhd;
}

}  // namespace

GmshField::GmshField(const std::function<Made()>& make, const Point& x, bool has_tensors) {
    static int made = 0;
    {
        const InGmsh gmsh;
        const std::size_t before = allocated();
        name_ = fmt::format("controlspace {}", ++made);
        try {
            gmsh::model::add(name_);
            constexpr int volume = 3;
            region_ = GModel::current()->getRegionByTag(gmsh::model::addDiscreteEntity(volume));
            model_ = GModel::current();
            made_ = make();
            gmsh::model::mesh::field::setAsBackgroundMesh(made_.field);
        } catch (const std::string& what) {
            throw InputError("Gmsh failed: " + what);
        }
        bytes_ = allocated() - before;
    }
    const std::size_t before = allocated();
    double size = 0;
    Tensor tensor;
    has_tensors ? tensors({&x, 1}, {&tensor, 1}) : sizes({&x, 1}, {&size, 1});
    bytes_ += allocated() - before;
}

GmshField::~GmshField() {
    const InGmsh gmsh;
    if (std::ranges::count(GModel::list, model_) == 0) return;  // Gmsh was closed
    try {
        GModel::setCurrent(model_);
        gmsh::model::remove();
        if (made_.view >= 0) gmsh::view::remove(made_.view);
    } catch (...) {  // nothing is left to do
    }
}

void GmshField::require_open() const {
    if (std::ranges::count(GModel::list, model_) == 0) {
        throw InputError(
            "Gmsh was closed, by a mesh that it made meanwhile: build the structure anew");
    }
    // Of the current model Gmsh asks for a size callback, too.
    GModel::setCurrent(model_);
}

void GmshField::sizes(std::span<const Point> x, std::span<double> out) const {
    const InGmsh gmsh;
    require_open();
    constexpr double nothing = 1e21;  // Gmsh's answer where there is no field is 1e22
    auto* const entity = reinterpret_cast<GEntity*>(region_);
    for (std::size_t i = 0; i < x.size(); ++i) {
        out[i] = BGM_MeshSizeWithoutScaling(entity, 0, 0, x[i].x(), x[i].y(), x[i].z());
        if (out[i] > 0 && out[i] < nothing) continue;
        throw InputError(
            fmt::format("Gmsh's field has no size at ({} {} {})", x[i].x(), x[i].y(), x[i].z()));
    }
}

void GmshField::tensors(std::span<const Point> x, std::span<Tensor> out) const {
    const InGmsh gmsh;
    require_open();
    constexpr int all = -1;
    constexpr double as_the_field = 0.05;  // how far outside of an element it finds a place
    std::vector<double> values;
    for (std::size_t i = 0; i < x.size(); ++i) {
        try {
            gmsh::view::probe(made_.view, x[i].x(), x[i].y(), x[i].z(), values, all, all, false,
                              as_the_field);
        } catch (const std::string& what) {
            throw InputError("Gmsh failed: " + what);
        }
        if (values.size() != out[i].size()) {
            throw InputError(fmt::format("Gmsh's view has no tensor at ({} {} {})", x[i].x(),
                                         x[i].y(), x[i].z()));
        }
        std::ranges::copy(values, out[i].begin());
    }
}

}  // namespace controlspace
