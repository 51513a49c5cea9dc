// SPDX-License-Identifier: Apache-2.0
#include "controlspace/space/control_space_file.h"

#define XXH_INLINE_ALL  // nothing to link with
#include <fmt/format.h>
#include <xxhash.h>

#include <algorithm>
#include <bit>
#include <cstring>
#include <fstream>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>

#include "controlspace/error.h"
#include "controlspace/version.h"
#include "files/output_file.h"
#include "files/text_file.h"
#include "space/saved.h"
#include "space/sealed_vdb.h"
#include "space/state.h"

namespace controlspace {

namespace {

// As that of PNG: a transfer as text, or by 7 bits, shows.
constexpr std::string_view signature =
    "\x89"
    "CTRL\r\n\x1a";
constexpr std::uint32_t order_mark = 0x01020304;
// Where sources may come later, builders kept what they requested beside the field, which is not
// read: they build again from the sources.
constexpr std::uint32_t oldest_version = 5;

struct Header {
    std::uint32_t version = control_space_file_version;
    std::uint32_t order = order_mark;
    std::uint64_t size = 0;
};
constexpr std::size_t header_size = signature.size() + sizeof(Header);
constexpr std::size_t checksum_size = sizeof(std::uint64_t);

Header header_of(std::string_view bytes) {
    Header header;
    std::memcpy(&header, bytes.data() + signature.size(), sizeof header);
    return header;
}

std::string_view bytes_of(const auto& value) {
    return {reinterpret_cast<const char*>(&value), sizeof value};
}

class Checksum {
public:
    Checksum() { XXH3_64bits_reset(&state_); }
    void add(std::string_view bytes) { XXH3_64bits_update(&state_, bytes.data(), bytes.size()); }
    std::uint64_t value() const { return XXH3_64bits_digest(&state_); }

private:
    XXH3_state_t state_;
};

void require_little_endian() {
    if constexpr (std::endian::native != std::endian::little) {
        throw InputError("control spaces are saved and loaded on little-endian machines only");
    }
}

// A level below that of the root stands for none.
template <class Depth, class State>
void exchange_depth(const char* name, Depth& depth, State& state) {
    int level = depth.value_or(-1);
    state(name, level);
    if constexpr (!std::is_const_v<Depth>) {
        if (level < 0) depth.reset();
        if (level >= 0) depth = level;
    }
}

template <class Self, class State>
void exchange(Self& options, State& state) {
    state("options.domain", options.domain);
    state("options.split", options.split, SplitRule::exact_golden);
    state("options.l_min", options.l_min);
    state("options.tolerance", options.tolerance);
    exchange_depth("options.kd_depth", options.kd_depth, state);
    exchange_depth("options.octree_depth", options.octree_depth, state);
    state("options.finest_length", options.finest_length);
    state("options.voxel", options.voxel);
    state("options.prune_delta", options.prune_delta);
    state("options.ratio", options.ratio);
    state("options.quadratic_form", options.quadratic_form, QuadraticForm::published);
    state("options.takes_later_sources", options.takes_later_sources);
    state("options.vertices_in_turn", options.vertices_in_turn);
    state("options.max_bytes", options.max_bytes);
    state("options.intersection", options.intersection, IntersectionRule::in_turn);
    state("options.h_max", options.h_max);
}

// There if it is true.
constexpr std::string_view grows_apart = "sources.grow_apart";

void fill(const CatalogueEntry& entry, const StateReader& state, SavedControlSpace& saved) {
    auto builder = entry.make(saved.recipe.options);
    auto* const own = dynamic_cast<SavedBuilder*>(builder.get());
    if (own == nullptr) {
        throw InputError("structure " + entry.id + " cannot be loaded: choose another");
    }
    own->set_recipe(saved.recipe);
    own->load(state);
    own->set_grows_apart(state.has(grows_apart));
    saved.space = builder->build({.precision = saved.recipe.precision});
    if (!saved.recipe.precision) saved.builder = std::move(builder);
}

// What lies between the header and the checksum.
std::string_view checked_body(std::string_view bytes, const std::string& name) {
    const auto fail = [&](const std::string& what) { throw InputError(name + " " + what); };
    if (!bytes.starts_with(signature.substr(0, bytes.size()))) {
        fail("is no control space: give a .ctrl file that was saved by this program");
    }
    if (bytes.size() < header_size + checksum_size) {
        fail("is truncated: copy it again, or save the control space again");
    }
    const Header header = header_of(bytes);
    if (header.order != order_mark) {
        fail("is altered (its order of bytes): copy it again, or save the control space again");
    }
    if (header.version > control_space_file_version) {
        fail(fmt::format("has format version {}, this program reads up to {}: use a newer one",
                         header.version, control_space_file_version));
    }
    if (header.version < oldest_version) {
        fail(
            fmt::format("has format version {}, which is read no longer: build it again from its "
                        "sources",
                        header.version));
    }
    if (bytes.size() < header.size) {
        fail(
            fmt::format("is truncated, {} of {} bytes: copy it again, or save the control space "
                        "again",
                        bytes.size(), header.size));
    }
    Checksum checksum;
    checksum.add(bytes.substr(0, bytes.size() - checksum_size));
    if (bytes.size() != header.size || !bytes.ends_with(bytes_of(checksum.value()))) {
        fail("is altered (its checksum differs): copy it again, or save the control space again");
    }
    return bytes.substr(header_size, bytes.size() - header_size - checksum_size);
}

void write(const std::filesystem::path& file, const StateWriter& state) {
    const Header header{.size = header_size + state.bytes().size() + checksum_size};
    Checksum checksum;
    OutputFile out(file);
    for (const std::string_view part :
         {signature, bytes_of(header), std::string_view(state.bytes())}) {
        checksum.add(part);
        out.write(part);
    }
    out.write(bytes_of(checksum.value()));
    out.commit();
}

// Whether a file is to be one of OpenVDB's.
bool is_for_openvdb(const std::filesystem::path& file) {
    return lower_case(file.extension().string()) == ".vdb";
}

void save(const std::filesystem::path& file, const Saved* saved) {
    require_little_endian();
    if (saved == nullptr || !saved->recipe()) {
        throw InputError(
            "a control space can be saved if an entry of the catalogue has made it, other than a "
            "foreign system");
    }
    const Recipe& recipe = *saved->recipe();
    const bool is_vdb = is_for_openvdb(file);
    const auto precision = is_vdb ? Precision::floats : recipe.precision;
    StateWriter state;
    state("written_by", "controlspace " + std::string(version()));
    state("structure", recipe.structure);
    exchange(recipe.options, state);
    if (precision) state("compact.precision", *precision, Precision::log8);
    if (is_vdb) {
        std::string bytes = saved->vdb_file(std::move(state));
        seal_vdb(bytes);
        OutputFile out(file);
        out.write(bytes);
        return out.commit();
    }
    saved->save(state);
    controlspace::save(state, saved->given(), recipe.options.takes_later_sources);
    if (saved->grows_apart()) state(grows_apart, std::uint64_t{1});
    write(file, state);
}

// The state in a file of OpenVDB's.
std::string state_in_vdb(const std::string& bytes, const std::string& name,
                         std::span<const CatalogueEntry> structures) {
    require_sealed_vdb(bytes, name);
    const auto entry = std::ranges::find_if(structures, &CatalogueEntry::has<VdbFiles>);
    if (entry == structures.end()) {
        throw InputError(name +
                         " is OpenVDB's, which this program does not have: use one that has it");
    }
    return entry->find<VdbFiles>()->state_in(bytes, name);
}

}  // namespace

// Others take the state over.
std::string Saved::vdb_file(StateWriter) const {  // NOLINT(performance-unnecessary-value-param)
    throw InputError(
        "only openvdb-tiles and openvdb-bricks can be saved to a .vdb, not their builders: name a "
        ".ctrl");
}

std::optional<Recipe> recipe_of(const ControlSpace& space) {
    const auto* saved = dynamic_cast<const Saved*>(&space);
    return saved == nullptr ? std::nullopt : saved->recipe();
}

bool holds_control_space(const std::filesystem::path& file) {
    if (file.extension() == ".ctrl") return true;
    std::error_code unknown;  // a pipe can be read only once
    if (!is_for_openvdb(file) || !std::filesystem::is_regular_file(file, unknown)) return false;
    constexpr std::size_t beginning = 1024;
    std::string bytes(beginning, '\0');
    std::ifstream stream(file, std::ios::binary);
    stream.read(bytes.data(), beginning);
    bytes.resize(static_cast<std::size_t>(stream.gcount()));
    return is_sealed_vdb(bytes);
}

void save_control_space(const std::filesystem::path& file, const ControlSpace& space) {
    save(file, dynamic_cast<const Saved*>(&space));
}
void save_control_space(const std::filesystem::path& file, const ControlSpaceBuilder& builder) {
    save(file, dynamic_cast<const Saved*>(&builder));
}

SavedControlSpace open_control_space(const std::filesystem::path& file,
                                     std::span<const CatalogueEntry> structures) {
    require_little_endian();
    const std::string name = file.string();
    std::string bytes = read_binary_file(file);
    const bool was_openvdbs = is_vdb(bytes);
    if (was_openvdbs) bytes = state_in_vdb(bytes, name, structures);
    const StateReader state(was_openvdbs ? bytes : checked_body(bytes, name), name);
    SavedControlSpace saved;
    std::string structure;
    state("structure", structure);
    exchange(saved.recipe.options, state);
    const CatalogueEntry* entry = find_entry(structures, structure);
    if (entry == nullptr) {
        throw InputError(fmt::format(
            "{} contains the structure {}, which this program does not have: use one that has it",
            name, quote(structure)));
    }
    saved.recipe.structure = entry->id;
    if (state.has("compact.precision")) {
        state("compact.precision", saved.recipe.precision.emplace(), Precision::log8);
    }
    state("written_by", saved.saved_by);
    saved.saved_by += fmt::format(
        ", format {}", was_openvdbs ? control_space_file_version : header_of(bytes).version);
    fill(*entry, state, saved);
    return saved;
}

std::unique_ptr<ControlSpace> load_control_space(const std::filesystem::path& file,
                                                 std::span<const CatalogueEntry> structures) {
    return open_control_space(file, structures).space;
}

std::unique_ptr<ControlSpaceBuilder> load_builder(const std::filesystem::path& file,
                                                  std::span<const CatalogueEntry> structures) {
    auto builder = open_control_space(file, structures).builder;
    if (!builder) {
        throw InputError(
            file.string() +
            " holds what is only read: save its builder, or build it with --precision as-made");
    }
    return builder;
}

}  // namespace controlspace
