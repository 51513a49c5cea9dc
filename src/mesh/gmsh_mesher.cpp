#include "mesh/gmsh_mesher.h"

#include <fmt/format.h>
#include <gmsh.h>

#include <Eigen/LU>
#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <exception>
#include <limits>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "error.h"
#include "measure/accuracy.h"

namespace controlspace {
namespace {

constexpr int triangle_type = 2;
constexpr int tet_type = 4;

double seconds_since(std::chrono::steady_clock::time_point start) {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// Gmsh, opened and closed again. It has no other state than that of the process.
class Session {
public:
    explicit Session(int threads) : lock_(mutex()) {
        constexpr bool read_user_settings = false;
        gmsh::initialize(0, nullptr, read_user_settings);
        gmsh::option::setNumber("General.Terminal", 0);
        gmsh::option::setNumber("General.NumThreads", threads);
        gmsh::model::add("controlspace");
    }
    ~Session() {
        try {
            gmsh::finalize();
        } catch (...) {  // nothing is left to do
        }
    }
    Session(const Session&) = delete;
    Session& operator=(const Session&) = delete;

private:
    static std::mutex& mutex() {
        static std::mutex only;
        return only;
    }
    std::unique_lock<std::mutex> lock_;
};

/// Runs `action` in a session; what Gmsh throws, texts and numbers among it, becomes InputError.
template <class Action>
auto in_session(int threads, Action&& action) {
    const auto refuse = [](std::string what) -> InputError {
        std::replace(what.begin(), what.end(), '\n', ' ');
        return InputError("Gmsh failed: " + what);
    };
    try {
        const Session session(threads);
        return action();
    } catch (const std::string& what) {
        throw refuse(what);
    } catch (int status) {
        throw refuse(fmt::format("status {}", status));
    }
}

/// Gmsh's tolerances are absolute, so it meshes the domain moved to the origin and scaled to a
/// longest edge of 1.
struct Scaling {
    Box domain;
    double scale;

    explicit Scaling(const Box& box) : domain(box), scale(box.edges().maxCoeff()) {}
    Point to_domain(double x, double y, double z) const {
        const Point p = domain.low + scale * Vector(x, y, z);
        return p.cwiseMax(domain.low).cwiseMin(domain.high);
    }
};

/// Answers Gmsh's questions. It may be asked by several threads, and must not throw into Gmsh: the
/// first exception is kept for later, and from then on all lengths are large, so that Gmsh is done
/// soon.
class SizeQuery {
public:
    SizeQuery(const MetricField& field, const Scaling& scaling, double factor)
        : field_(field), scaling_(scaling), factor_(factor) {}

    double operator()(double x, double y, double z) {
        if (failed_) return 1;
        // Reading the clock takes as long as a query: few are timed.
        constexpr std::size_t timed_one_in = 16;
        if (count_++ % timed_one_in != 0) return scaled_length(x, y, z);
        const auto start = Clock::now();
        const double h = scaled_length(x, y, z);
        nanoseconds_ += timed_one_in * (nanoseconds_between(start, Clock::now()) - clock_cost_);
        return h;
    }

    void rethrow_failure() const {
        if (failed_) std::rethrow_exception(failure_);
    }
    void report(GmshRun& run) const {
        run.queries = count_;
        run.query_seconds = 1e-9 * static_cast<double>(nanoseconds_);
        run.anisotropic = anisotropic_;
    }

private:
    using Clock = std::chrono::steady_clock;

    static std::int64_t nanoseconds_between(Clock::time_point a, Clock::time_point b) {
        return std::chrono::duration_cast<std::chrono::nanoseconds>(b - a).count();
    }
    static std::int64_t cost_of_clock() {
        std::int64_t least = std::numeric_limits<std::int64_t>::max();
        for (int i = 0; i < 1000; ++i) {
            const auto start = Clock::now();
            least = std::min(least, nanoseconds_between(start, Clock::now()));
        }
        return least;
    }

    double scaled_length(double x, double y, double z) {
        try {
            return factor_ * smallest_length(scaling_.to_domain(x, y, z)) / scaling_.scale;
        } catch (...) {
            const std::lock_guard lock(mutex_);
            if (!failed_) failure_ = std::current_exception();
            failed_ = true;
        }
        return 1;
    }

    double smallest_length(const Point& p) {
        const Metric m = metric_at(field_, p);
        if (!is_positive_definite(m)) {
            throw InputError(fmt::format("the field at ({}, {}, {}) is no metric: {}", p.x(), p.y(),
                                         p.z(), to_string(m)));
        }
        if (is_isotropic(m)) return m.xx;
        // Blending isotropic metrics leaves rounding.
        constexpr double isotropic_within = 1.01;
        const auto lengths = eigen_frame(m).lengths;
        if (lengths[2] > isotropic_within * lengths[0]) anisotropic_ = true;
        return lengths[0];
    }

    const MetricField& field_;
    const Scaling& scaling_;
    const double factor_;
    const std::int64_t clock_cost_ = cost_of_clock();
    std::atomic<std::size_t> count_ = 0;
    std::atomic<std::int64_t> nanoseconds_ = 0;
    std::atomic<bool> anisotropic_ = false;
    std::atomic<bool> failed_ = false;
    std::mutex mutex_;
    std::exception_ptr failure_;
};

void set_size_callback(SizeQuery& query) {
#if GMSH_API_VERSION_MAJOR > 4 || (GMSH_API_VERSION_MAJOR == 4 && GMSH_API_VERSION_MINOR >= 9)
    // From 4.9 on, what is returned takes the place of the other sizes.
    gmsh::model::mesh::setSizeCallback(
        [&query](int, int, double x, double y, double z, double other) {
            return std::min(other, query(x, y, z));
        });
#else
    gmsh::model::mesh::setSizeCallback(
        [&query](int, int, double x, double y, double z) { return query(x, y, z); });
#endif
}

void add_box(const Scaling& scaling) {
    const Vector edges = scaling.domain.edges() / scaling.scale;
    gmsh::model::occ::addBox(0, 0, 0, edges.x(), edges.y(), edges.z());
    gmsh::model::occ::synchronize();
}

void set_options(const GmshOptions& options) {
    const auto set = [](const char* name, double value) { gmsh::option::setNumber(name, value); };
    // Sizes come from the callback alone.
    set("Mesh.MeshSizeFromPoints", 0);
    set("Mesh.MeshSizeFromCurvature", 0);
    set("Mesh.MeshSizeExtendFromBoundary", 0);
    constexpr double delaunay = 1, hxt = 10;
    set("Mesh.Algorithm3D", options.algorithm == GmshAlgorithm::hxt ? hxt : delaunay);
}

void generate(GmshAlgorithm algorithm, double optimize) {
    constexpr const char* threshold = "Mesh.OptimizeThreshold";
    constexpr int volumes = 3;
    if (algorithm == GmshAlgorithm::delaunay) {
        gmsh::option::setNumber(threshold, optimize);
        gmsh::model::mesh::generate(volumes);
        return;
    }
    // HXT's own improvement does not end at high thresholds: it keeps its default, and Gmsh's
    // common one goes on from there.
    gmsh::model::mesh::generate(volumes);
    double reached = 0;
    gmsh::option::getNumber(threshold, reached);
    if (optimize <= reached) return;
    gmsh::option::setNumber(threshold, optimize);
    gmsh::model::mesh::optimize("");
}

template <std::size_t n>
std::vector<std::array<VertexIndex, n>> elements(int type,
                                                 const std::vector<VertexIndex>& index_of_tag) {
    std::vector<std::size_t> tags, nodes;
    gmsh::model::mesh::getElementsByType(type, tags, nodes);
    std::vector<std::array<VertexIndex, n>> result(nodes.size() / n);
    for (std::size_t i = 0; i < nodes.size(); ++i) {
        result[i / n][i % n] = index_of_tag[nodes[i]];
    }
    return result;
}

TetMesh take_mesh(const Scaling& scaling) {
    std::vector<std::size_t> tags;
    std::vector<double> coordinates, unused;
    gmsh::model::mesh::getNodes(tags, coordinates, unused);
    TetMesh mesh;
    std::vector<VertexIndex> index_of_tag;
    for (std::size_t i = 0; i < tags.size(); ++i) {
        if (tags[i] >= index_of_tag.size()) index_of_tag.resize(tags[i] + 1);
        index_of_tag[tags[i]] = static_cast<VertexIndex>(i);
        const double* x = &coordinates[3 * i];
        mesh.vertices.push_back(scaling.to_domain(x[0], x[1], x[2]));
    }
    mesh.triangles = elements<3>(triangle_type, index_of_tag);
    mesh.tets = elements<4>(tet_type, index_of_tag);
    turn_upright(mesh);
    return mesh;
}

/// Tetrahedra of the lengths that `field` asks for, roughly: places between the samples may ask for
/// more.
double estimated_tets(const Box& domain, const MetricField& field) {
    constexpr int samples = 24;
    const std::vector<Point> places = cell_centres(domain, samples);
    std::vector<Metric> metrics(places.size());
    field.evaluate(places, metrics);
    const double cell = domain.edges().prod() / static_cast<double>(places.size());
    const double per_unit = 6 * std::sqrt(2.0);  // regular ones of edge 1 in a unit of volume
    double sum = 0;
    for (const Metric& m : metrics) sum += per_unit * cell / m.matrix().determinant();
    return sum;
}

void require_valid(const Box& domain, const MetricField& field, const GmshOptions& options) {
    require_volume(domain);
    const double factor = options.factor.value_or(1);
    if (!std::isfinite(factor) || factor <= 0) {
        throw InputError(fmt::format("factor {} of sizes: give a positive one", factor));
    }
    const double optimize = options.optimize.value_or(0);
    if (!(optimize >= 0 && optimize < 1)) {
        throw InputError(
            fmt::format("optimize {}: give a quality from 0 to below 1; 0.7 is good, "
                        "from 0.8 on it takes long",
                        optimize));
    }
    const double tets = estimated_tets(domain, field);
    if (!(tets <= options.max_tets)) {
        throw InputError(
            fmt::format("the field asks for some {:.2g} tetrahedra, more than {:.2g}: "
                        "ask for larger lengths, or allow more",
                        tets, options.max_tets));
    }
}

}  // namespace

double standard_factor(GmshAlgorithm algorithm) {
    return algorithm == GmshAlgorithm::hxt ? 0.70 : 0.77;
}

double standard_optimize(GmshAlgorithm algorithm) {
    return algorithm == GmshAlgorithm::hxt ? 0.6 : 0.7;
}

GmshRun mesh_with_gmsh(const Box& domain, const MetricField& field, const GmshOptions& options) {
    require_valid(domain, field, options);
    const Scaling scaling(domain);
    SizeQuery query(field, scaling, options.factor.value_or(standard_factor(options.algorithm)));
    return in_session(options.threads, [&] {
        add_box(scaling);
        set_options(options);
        set_size_callback(query);
        GmshRun run;
        const auto start = std::chrono::steady_clock::now();
        try {
            generate(options.algorithm,
                     options.optimize.value_or(standard_optimize(options.algorithm)));
        } catch (...) {
            query.rethrow_failure();  // the cause, if it is ours
            throw;
        }
        run.seconds = seconds_since(start);
        query.rethrow_failure();
        query.report(run);
        run.mesh = take_mesh(scaling);
        if (run.mesh.tets.empty()) {
            std::string why;
            gmsh::logger::getLastError(why);
            throw InputError(fmt::format("Gmsh made no tetrahedra{}{}: try the other algorithm",
                                         why.empty() ? "" : ": ", why));
        }
        return run;
    });
}

void write_msh(const std::filesystem::path& path, const TetMesh& mesh) {
    in_session(1, [&] {
        constexpr int surface = 2, volume = 3;
        const auto add = [](int dimension) { return gmsh::model::addDiscreteEntity(dimension); };
        const int box = add(volume), sides = add(surface);
        std::vector<std::size_t> tags(mesh.vertices.size());
        std::vector<double> coordinates;
        for (std::size_t i = 0; i < tags.size(); ++i) {
            tags[i] = i + 1;
            coordinates.insert(coordinates.end(), mesh.vertices[i].begin(), mesh.vertices[i].end());
        }
        gmsh::model::mesh::addNodes(volume, box, tags, coordinates);
        std::size_t last_tag = 0;
        const auto add_elements = [&](int entity, int type, const auto& elements) {
            std::vector<std::size_t> element_tags, nodes;
            for (const auto& element : elements) {
                element_tags.push_back(++last_tag);
                for (const VertexIndex i : element) nodes.push_back(i + 1);
            }
            gmsh::model::mesh::addElementsByType(entity, type, element_tags, nodes);
        };
        add_elements(sides, triangle_type, mesh.triangles);
        add_elements(box, tet_type, mesh.tets);
        // Gmsh goes by the ending of the name.
        std::filesystem::path partial = path;
        partial += ".partial.msh";
        gmsh::option::setNumber("Mesh.Binary", 1);
        std::error_code error;
        try {
            gmsh::write(partial.string());
            std::filesystem::rename(partial, path, error);
        } catch (...) {
            std::filesystem::remove(partial, error);
            throw;
        }
        if (error)
            throw InputError(fmt::format("cannot write {}: {}", path.string(), error.message()));
    });
}

}  // namespace controlspace
