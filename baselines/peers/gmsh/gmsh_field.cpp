#include "baselines/peers/gmsh/gmsh_field.h"

#include <fmt/format.h>
#include <gmsh.h>
#include <malloc.h>

#include <algorithm>
#include <exception>
#include <mutex>
#include <vector>

#include "controlspace/error.h"

// Exported by Gmsh 4.8, but declared in no header that is installed: of each class what is called
// here, none of which is virtual in the call.
class GEntity;
class SMetric3 {
public:
    std::array<double, 6> lower_triangle{};
};
class FieldManager {
public:
    Field* get(int tag);
};
class GModel {
public:
    static std::vector<GModel*> list;
    static GModel* current(int index = -1);
    static int setCurrent(GModel* model);
    FieldManager* getFields();
};
class PostViewField {
public:
    double operator()(double x, double y, double z, GEntity* entity);
    void operator()(double x, double y, double z, SMetric3& metric, GEntity* entity);
};
class StructuredField {
public:
    double operator()(double x, double y, double z, GEntity* entity);
};

namespace controlspace {

namespace {

std::mutex& only_gmsh() {
    static std::mutex mutex;
    return mutex;
}

void open_locked() {
    if (!GModel::list.empty()) return;
    gmsh::initialize(0, nullptr, false);  // not open, or closed again
    gmsh::option::setNumber("General.Terminal", 0);
}

/// Leaves the model that was current so in the end.
class KeepsCurrent {
public:
    KeepsCurrent() : before_(GModel::current()) {}
    ~KeepsCurrent() {
        if (std::ranges::count(GModel::list, before_) != 0) GModel::setCurrent(before_);
    }
    KeepsCurrent(const KeepsCurrent&) = delete;
    KeepsCurrent& operator=(const KeepsCurrent&) = delete;

private:
    GModel* before_;
};

/// Gmsh throws strings, and in places more.
void with_gmsh_errors(const auto& action) {
    try {
        action();
    } catch (const std::string& what) {
        throw InputError("Gmsh failed: " + what);
    } catch (const std::exception&) {
        throw;
    } catch (...) {
        throw InputError("Gmsh failed");
    }
}

std::ptrdiff_t allocated() {
    const auto counts = mallinfo2();
    return static_cast<std::ptrdiff_t>(counts.uordblks + counts.hblkhd);
}

}  // namespace

void open_gmsh() {
    const std::lock_guard lock(only_gmsh());
    with_gmsh_errors(open_locked);
}

GmshField::GmshField(const std::function<void(Made&)>& make, const Point& x, bool has_tensors) {
    static int made = 0;
    try {
        with_gmsh_errors([&] {
            const std::lock_guard lock(only_gmsh());
            open_locked();
            const KeepsCurrent current;
            const std::ptrdiff_t before = allocated();
            name_ = fmt::format("controlspace {}", ++made);
            gmsh::model::add(name_);
            model_ = GModel::current();
            make(made_);
            field_ = model_->getFields()->get(made_.field);
            bytes_ = allocated() - before;
        });
        ask_once(x, has_tensors);
    } catch (...) {
        remove();
        throw;
    }
}

void GmshField::ask_once(const Point& x, bool has_tensors) {
    const std::ptrdiff_t before = allocated();
    double size = 0;
    Tensor tensor;
    has_tensors ? tensors({&x, 1}, {&tensor, 1}) : sizes({&x, 1}, {&size, 1});
    bytes_ += allocated() - before;
}

GmshField::~GmshField() { remove(); }

void GmshField::remove() noexcept {
    try {
        const std::lock_guard lock(only_gmsh());
        if (std::ranges::count(GModel::list, model_) == 0) return;  // Gmsh was closed
        const KeepsCurrent current;
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
}

void GmshField::sizes(std::span<const Point> x, std::span<double> out) const {
    const std::lock_guard lock(only_gmsh());
    require_open();
    const auto evaluate = [&](auto& field) {
        constexpr double nothing = 1e21;  // Gmsh's answer where there is no field is 1e22
        for (std::size_t i = 0; i < x.size(); ++i) {
            out[i] = field(x[i].x(), x[i].y(), x[i].z(), nullptr);
            if (out[i] > 0 && out[i] < nothing) continue;
            throw InputError(
                fmt::format("Gmsh's field has no size at ({} {} {}): leave it out of --structures",
                            x[i].x(), x[i].y(), x[i].z()));
        }
    };
    with_gmsh_errors([&] {
        if (made_.view >= 0) {
            evaluate(*reinterpret_cast<PostViewField*>(field_));
        } else {
            evaluate(*reinterpret_cast<StructuredField*>(field_));
        }
    });
}

void GmshField::tensors(std::span<const Point> x, std::span<Tensor> out) const {
    const std::lock_guard lock(only_gmsh());
    require_open();
    auto& field = *reinterpret_cast<PostViewField*>(field_);
    with_gmsh_errors([&] {
        for (std::size_t i = 0; i < x.size(); ++i) {
            SMetric3 metric;
            field(x[i].x(), x[i].y(), x[i].z(), metric, nullptr);
            out[i] = metric.lower_triangle;
        }
    });
}

}  // namespace controlspace
