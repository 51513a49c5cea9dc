// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace controlspace {

/// The place of a member of members, for parameters (access.h): of(&Study::sources,
/// &SourcesChoice::h_min).
template <class... Members>
auto of(Members... members) {
    return [=](auto& target) -> auto& { return (target.*....*members); };
}

}  // namespace controlspace
