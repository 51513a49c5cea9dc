#include "controlspace/trees/detail/nearby_field.h"

#include "cones/cone_field.h"
#include "cones/nearby_cones.h"
#include "controlspace/metric/intersection.h"
#include "controlspace/metric/nonconformity.h"

namespace controlspace {

struct NearbyField::Search {
    const GoalField& field;
    Box box = {};
    ConeField::Memory memory = {};
    NearbyCones gathered = {}, cones = {};
    bool is_gathered = false;
    bool are_few = false;

    bool takes_long() const { return !field.cones().is_isotropic(); }
    void gather() {
        if (is_gathered) return;
        is_gathered = true;
        are_few = field.cones().gather(box, gathered, memory);
        if (are_few) cones.narrow(gathered, box);
    }
    void by_memory(std::span<const Point> x, std::span<Metric> out) {
        field.cones().evaluate(x, out, memory, field.continuous_at(x));
    }
    void by_few(std::span<const Point> x, std::span<Metric> out) const {
        const std::vector<Metric> further = field.continuous_at(x);
        for (std::size_t i = 0; i < x.size(); ++i) {
            out[i] = Metric::isotropic(cones.smallest_length(x[i]));
            if (!further.empty()) out[i] = intersection(out[i], further[i]);
        }
    }
};

NearbyField::NearbyField(const GoalField& field) : search_(new Search{.field = field}) {}
NearbyField::NearbyField(const NearbyField& other) : search_(new Search(*other.search_)) {}
NearbyField::~NearbyField() = default;

void NearbyField::enter(const Box& box, bool at_many_points) {
    search_->box = box;
    search_->memory.hint = 0;
    search_->is_gathered = !at_many_points;
    search_->are_few = false;
}

void NearbyField::evaluate(std::span<const Point> x, std::span<Metric> out) {
    search_->gather();
    if (search_->are_few) {
        search_->by_few(x, out);
    } else {
        search_->by_memory(x, out);
    }
}

double NearbyField::evaluate_roughly(std::span<const Point> x, bool shared, std::span<Metric> out) {
    const GoalField& field = search_->field;
    if (shared && search_->takes_long()) {
        for (std::size_t i = 0; i < x.size(); ++i) out[i] = at(x[i]);
        return 1;
    }
    search_->gather();
    if (search_->are_few || !field.has_ranges()) {
        evaluate(x, out);
        return 1;
    }
    field.cones().evaluate_roughly(x, field.negligible(), out, search_->memory);
    return 1 + field.negligible();
}

Metric NearbyField::at(const Point& x) {
    const GoalField& field = search_->field;
    const bool takes_long = search_->takes_long();
    Metric m;
    if (takes_long && field.recall(x, m)) return m;
    search_->by_memory({&x, 1}, {&m, 1});
    if (takes_long) field.remember(x, m);
    return m;
}

std::optional<NearbyField::Doubt> NearbyField::doubt_of(const std::array<double, 8>& at_corners) {
    const GoalField& field = search_->field;
    const auto doubt = field.cones().doubt_of(
        {search_->box, at_corners}, largest_factor_within(field.target()), search_->memory);
    if (!doubt) return std::nullopt;
    return Doubt{doubt->where, doubt->is_certain};
}

NearbyField::Range NearbyField::range() {
    const auto [least, most] = search_->field.cones().range_in(search_->box, search_->memory);
    return {least, most};
}

}  // namespace controlspace
