// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <mpi.h>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "controlspace/geometry/box.h"
#include "controlspace/metric/metric.h"
#include "controlspace/sources/point_source.h"
#include "controlspace/space/control_space.h"
#include "controlspace/space/space_options.h"

namespace controlspace {

struct DistributedOptions {
    std::string structure = "K_oL";     ///< K_oL, K_oV or K_oLB
    SpaceOptions space = {};            ///< the domain, and how the tree is made
    std::optional<double> target = {};  ///< δ that it is adapted to; none: inserted and graded
    /// Octants with more sources than the mean of so many a rank are cut further, if the tree is.
    std::uint64_t octants_per_rank = 128;
};

/// What one rank held and sent.
struct RankReport {
    std::uint64_t given = 0;     ///< sources that the rank came with
    std::uint64_t owned = 0;     ///< sources in its octants
    std::uint64_t kept = 0;      ///< of them, those that none of the others there dominates
    std::uint64_t received = 0;  ///< sources of other ranks that matter in its octants
    std::uint64_t octants = 0, octants_of_all = 0;
    std::uint64_t leaves = 0;  ///< of its tree, with the few outside of its octants
    std::uint64_t bytes_sent = 0, messages_sent = 0;
    bool has_tensors = false;  ///< some rank has: answers are not the same to the bit
    double cpu_s = 0;          ///< of building
    bool met = true;           ///< whether an adapted tree keeps the target, on all ranks
    std::string remark;        ///< why not, on the first rank where it does not
};

/// An octree that is built by all ranks of a communicator, each a part of it.
///
/// p4est orders octants of the domain and shares them out. The sources that can matter in a rank's
/// octants go there in one exchange; then it builds its part of the tree alone. Its answers are
/// those of make_control_space with all sources in the order of ranks, to the bit, whatever the
/// number of ranks and however sources are shared out among them, as long as all are isotropic.
///
/// If some are tensors, bits depend on how the field was searched for. The leaves of an inserted
/// tree are the same; metrics that are graded to the field are within all cones, and their log det
/// within 3 ln(1.01) of the best, as the serial ones are, so that the log dets of the two differ by
/// no more. Adapted, the leaves too may be others: each keeps the target where it was sampled.
///
/// All members that say so are collective: all ranks call them, in the same order. What fails on
/// one rank throws the same InputError on all.
class DistributedSpace {
public:
    /// Collective. `sources` are this rank's; the communicator must outlive it. Throws InputError
    /// as make_control_space does, for structures that depend on the order in which leaves are cut,
    /// and for tensors that are to be intersected in turn.
    DistributedSpace(MPI_Comm comm, std::span<const PointSource> sources,
                     const DistributedOptions& options);
    ~DistributedSpace();
    DistributedSpace(DistributedSpace&&) noexcept;
    DistributedSpace& operator=(DistributedSpace&&) noexcept;

    /// The field in this rank's octants, exact there and no shorter elsewhere.
    const ControlSpace& own() const;
    /// This rank's octants. A face between two belongs to the low side.
    std::vector<Box> octants() const;
    /// The rank that owns the octant of a place; of one outside the domain, of the nearest in it.
    int owner_of(const Point& x) const;

    /// Collective: the field in `box`, each rank's own, where it answers as the whole would. It
    /// needs no communication afterwards.
    std::unique_ptr<ControlSpace> field_for(const Box& box) const;

    /// Collective: metrics at places of this rank, anywhere, by the ranks that own them.
    void sample(std::span<const Point> x, std::span<Metric> out) const;

    /// Collective: writes each rank's octants as a piece, NAME_0.ctrl, NAME_1.ctrl, ..., and the
    /// index NAME.pctrl: load_octree_pieces (controlspace/trees/octree_pieces.h) reads it, whole or
    /// in part, in any number of processes. Throws InputError on all ranks if a file cannot be
    /// written, and leaves none.
    void save(const std::filesystem::path& index) const;
    /// Collective: the same of the leaves, for ParaView: NAME.pvtu and NAME_0.vtu, NAME_1.vtu, ...
    void write_leaves(const std::filesystem::path& index) const;

    /// Collective: the checksum (measure/access_time.h) of the metrics at `n` random places, as the
    /// program's results have it. The same on all ranks.
    std::uint64_t checksum(std::size_t n, std::uint64_t seed) const;

    /// With what was sent so far.
    RankReport report() const;

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace controlspace
