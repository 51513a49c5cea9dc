// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "controlspace/io/read_sources.h"
#include "controlspace/sources/point_source.h"

namespace controlspace {

/// Sources as a table: a first line that names the columns, in any order, then one source a line.
/// Columns x, y, z and one of
///   h                                   the same length in every direction;
///   m_xx, m_yy, m_zz, m_xy, m_xz, m_yz  the tensor of lengths M (not M^-2);
///   h1, h2, h3, e1x, e1y, e1z, e2x, e2y, e2z
///                                       lengths along e1, e2 and e1 x e2; the directions need not
///                                       be unit vectors but must be orthogonal to 1e-3.
/// A column g, if there is one, gives each source a gradation ratio of its own (0: the field's).
/// ParaView's names "Points:0" to "Points:2" stand for x, y, z. Other columns are not read, which
/// `options.remark` is told. Separated by commas, or by semicolons or tabs, where numbers may have
/// decimal commas; names and numbers may be quoted, exponents begin with e or d. Blank lines, rows
/// of blanks and lines that start with # are skipped; lines end in LF or CRLF. Throws InputError
/// "name:line: what is wrong".
std::vector<PointSource> read_csv_sources(const std::filesystem::path& path,
                                          const ReadOptions& options = {});

/// The same from `text`; `path` is used in messages.
std::vector<PointSource> parse_csv_sources(std::string_view text, const std::filesystem::path& path,
                                           const ReadOptions& options = {});

/// The line (from 1) of the source of index `index` (from 0) in a file that was read.
std::string csv_line_of(const std::filesystem::path& path, std::size_t index);

/// Points from a table of the same kind: columns x, y and z; other columns are ignored.
std::vector<Point> read_csv_points(const std::filesystem::path& path);
std::vector<Point> parse_csv_points(std::string_view text, const std::filesystem::path& path);

/// Writes sources that read back to the last bit, with column h where all are isotropic and as
/// tensors otherwise. The file appears whole or not at all; throws InputError if it cannot.
void write_csv_sources(const std::filesystem::path& path, std::span<const PointSource> sources);

}  // namespace controlspace
