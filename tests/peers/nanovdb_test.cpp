#include <catch2/catch.hpp>

#include "controlspace/metric/nonconformity.h"
#include "peers/peers.h"

namespace controlspace {

TEST_CASE("NanoVDB answers as the structure that it is a copy of") {
    const Work work = GENERATE(oblong_box(), anisotropic_oblong_box(), flat_box());
    CAPTURE(work.name);
    const auto places = places_in(work);
    const auto nano = answers_at(*finished("nanovdb-trilinear", work), places);
    const auto open = answers_at(*finished("openvdb-vec3s-trilinear", work), places);
    CHECK(differing(nano, open) == 0);

    const auto nearest = answers_at(*finished("nanovdb-nearest", work), places);
    const auto uniform = answers_at(*finished("uniform-nearest", work), places);
    for (std::size_t i = 0; i < places.size(); ++i) {
        REQUIRE(nonconformity(nearest[i], uniform[i]) < 1e-6);
    }
}

TEST_CASE("NanoVDB counts its two blocks of memory: floats take half of doubles") {
    const Work work = oblong_box();
    const Footprint nano = finished("nanovdb-trilinear", work)->footprint();
    const Footprint open = finished("openvdb-vec3s-trilinear", work)->footprint();
    CHECK(nano.control_nodes == open.control_nodes);
    CHECK(nano.bytes_payload == open.bytes_payload);
}

}  // namespace controlspace
