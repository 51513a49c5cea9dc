// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <utility>

#include "controlspace/space/control_space_file.h"
#include "space/given_sources.h"
#include "space/state.h"

namespace controlspace {

/// What save_control_space can write: finished structures and builders derive from it.
class Saved {
public:
    virtual ~Saved() = default;

    /// Writes all that it holds, but for what its recipe gives. Throws InputError where it cannot
    /// be saved.
    virtual void save(StateWriter& state) const = 0;
    /// A .vdb file (VdbFiles) of what it answers in floats, from what its recipe gives; unsealed
    /// (sealed_vdb.h). Throws InputError where it has none.
    virtual std::string vdb_file(StateWriter state) const;

    /// The entry of the catalogue and the options that it was made by; none if it was made in
    /// another way.
    const std::optional<Recipe>& recipe() const { return recipe_; }
    void set_recipe(std::optional<Recipe> recipe) { recipe_ = std::move(recipe); }

    /// What it was given: the sources, in builders of control nodes; and where sources may come
    /// later, in all builders and in what they build.
    const Given& given() const { return given_; }
    void set_given(Given given) { given_ = std::move(given); }

    /// Whether sources have gradation ratios of their own: where the sources are not known any
    /// more, gradation from node to node would take the growth of such cones away.
    bool grows_apart() const { return grows_apart_; }
    void set_grows_apart(bool grows_apart) { grows_apart_ = grows_apart; }

private:
    bool grows_apart_ = false;
    std::optional<Recipe> recipe_;

protected:
    Given given_;
};

/// A builder that takes back what was saved. Throws InputError where what is read is not sound; it
/// is undefined then.
class SavedBuilder : public Saved {
public:
    /// Into a new builder, made with the same options.
    virtual void load(const StateReader& state) = 0;
};

}  // namespace controlspace
