#include <algorithm>
#include <utility>
#include <vector>

#include "controlspace/error.h"
#include "controlspace/geometry/subdivision.h"
#include "files/output_file.h"
#include "io/text/cells.h"
#include "io/text/lengths_at.h"
#include "io/text/size_files.h"

namespace controlspace {

SizeFile write_netgen_sizes(const std::filesystem::path& path, const ControlSpace& space) {
    constexpr std::size_t most_points = 20'000'000;
    constexpr double spacing =
        0.5;  // lengths: at 1, Netgen's are up to 1.4 times too large between
    std::vector<std::pair<double, Point>> points;
    bool has_tensors = false;
    std::vector<Box> boxes = elements_of(space);
    while (!boxes.empty()) {
        std::vector<Point> centres;
        for (const Box& box : boxes) centres.push_back(box.centre());
        const Lengths lengths = lengths_at(space, centres);
        has_tensors = has_tensors || lengths.has_tensors;
        std::vector<Box> parts;
        for (std::size_t i = 0; i < boxes.size(); ++i) {
            // Along short edges of a cell there is room for one point.
            Subdivision cut = octants(boxes[i]);
            for (Axis a = 0; a < 3; ++a) {
                cut.cuts[static_cast<std::size_t>(a)] =
                    boxes[i].edges()[a] > spacing * lengths.values[i];
            }
            if (cut.children() == 1 || !cut.is_proper()) {
                points.emplace_back(lengths.values[i], centres[i]);
            } else {
                for (int c = 0; c < cut.children(); ++c) parts.push_back(cut.child(c));
            }
        }
        if (points.size() + parts.size() > most_points) {
            throw InputError(
                "the field requests more than 20 million points, too many for Netgen: give "
                "larger lengths, or a smaller --domain");
        }
        boxes = std::move(parts);
    }
    // Netgen passes over a point where its length is small enough already.
    std::ranges::stable_sort(points, {}, [](const auto& point) { return point.first; });
    OutputFile file(path);
    file.print("{}\n", points.size());
    for (const auto& [length, x] : points) file.print("{} {} {} {}\n", x.x(), x.y(), x.z(), length);
    file.write("0\n");  // lines
    file.commit();
    return {points.size(), has_tensors};
}

}  // namespace controlspace
