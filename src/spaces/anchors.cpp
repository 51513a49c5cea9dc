#include "spaces/anchors.h"

#include <algorithm>
#include <numeric>

namespace controlspace {

namespace {

// Where the field of a leaf is judged: its corners, and last its centre. Of tensors the centre
// alone: there hundreds of cones each cut a little, so corners would be hunted without end.
template <class Size>
constexpr std::size_t corners = std::is_same_v<Size, double> ? 8 : 0;
template <class Size>
constexpr std::size_t places = corners<Size> + 1;
constexpr std::size_t candidates_at_most = Anchors::most + 1;

// Relative gains that count: of the size at the centre, and of the sum of all sizes. The former is
// rounding; the latter saves moves that nobody would notice.
constexpr double gain_at_centre = 1e-9;
constexpr double gain_in_sum = 1e-4;

template <class Size>
using Field = std::array<Size, places<Size>>;

struct Judgement {
    double centre, sum;

    template <class Sizes>
    explicit Judgement(const Sizes& field) : centre(mean_length(field.back())), sum(0) {
        for (const auto& size : field) sum += mean_length(size);
    }
    bool improves(const Judgement& old) const {
        if (centre < old.centre * (1 - gain_at_centre)) return true;
        return centre <= old.centre && sum < old.sum * (1 - gain_in_sum);
    }
};

template <class Size>
Field<Size> intersected(const Field<Size>& a, const Field<Size>& b) {
    Field<Size> field;
    for (std::size_t p = 0; p < places<Size>; ++p) field[p] = intersection(a[p], b[p]);
    return field;
}

}  // namespace

// Over the leaf a cone shrinks by at most (g-1) times half of the leaf's diagonal, and the field
// grows by as much: a newcomer that is larger by both at the centre is of no use.
template <class Size>
bool ConeIntersection<Size>::may_matter(SourceIndex newcomer, const Box& box,
                                        const Size& here) const {
    const Size there = cone(newcomer, box.centre());
    if constexpr (std::is_same_v<Size, double>) {
        return there - (g_ - 1) * box.edges().norm() < here;
    } else {
        return !is_within(here, 1, there);
    }
}

template <class Size>
Anchors ConeIntersection<Size>::improved(const Anchors& current, SourceIndex newcomer,
                                         const Box& box) const {
    std::array<SourceIndex, candidates_at_most> candidate{};
    std::array<Field<Size>, candidates_at_most> cones;
    std::size_t n = 0;
    const auto enter = [&](SourceIndex source) {
        candidate[n] = source;
        for (std::size_t p = 0; p < places<Size>; ++p) {
            const Point x = p < corners<Size> ? corner(box, static_cast<int>(p)) : box.centre();
            cones[n][p] = cone(source, x);
        }
        ++n;
    };
    for (const SourceIndex source : current.span()) enter(source);
    enter(newcomer);

    Field<Size> nothing;
    nothing.fill(largest_);
    Field<Size> old = nothing;
    for (std::size_t i = 0; i + 1 < n; ++i) old = intersected<Size>(old, cones[i]);

    // First what governs the centre, then whatever gains most.
    Anchors chosen;
    Field<Size> field = nothing;
    std::array<bool, candidates_at_most> taken{};
    for (std::size_t k = 0; k < Anchors::most; ++k) {
        std::size_t best = n;
        Field<Size> best_field = field;
        for (std::size_t i = 0; i < n; ++i) {
            if (taken[i]) continue;
            const Field<Size> with = intersected<Size>(field, cones[i]);
            const Judgement judgement(with);
            const Judgement leader(best_field);
            const bool better =
                k == 0 ? judgement.centre < leader.centre : judgement.improves(leader);
            if (!better) continue;
            best = i;
            best_field = with;
        }
        if (best == n) break;
        taken[best] = true;
        chosen.add(candidate[best]);
        field = best_field;
    }
    return Judgement(field).improves(Judgement(old)) ? chosen : current;
}

template class ConeIntersection<double>;
template class ConeIntersection<Metric>;

}  // namespace controlspace
