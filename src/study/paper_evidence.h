#pragma once

#include <span>
#include <string_view>
#include <vector>

#include "study/paper.h"
#include "study/row.h"
#include "study/study.h"

namespace controlspace {

/// The paper's tables that can be measured here.
enum class PaperTable { size, creation, access, delta_r };
constexpr PaperTable paper_tables[] = {PaperTable::size, PaperTable::creation, PaperTable::access,
                                       PaperTable::delta_r};

/// "Table 1: size as published [MB]".
std::string_view title(PaperTable table);

/// What `table` shows, in its own unit: MB (1e6 bytes, the paper's accounting), s, µs, δ_R.
double value(PaperTable table, const Measures& ours);
double value(PaperTable table, const PaperRow& paper);

/// Rows of one or more studies of the paper's sphere, as evidence for and against its tables.
class PaperEvidence {
public:
    /// A row of ours that the paper has too.
    struct Cell {
        const Row* ours;
        const PaperRow* paper;
    };

    /// Takes over the rows in the paper's box, and in a box that is longer by a billionth or so. Of
    /// rows with the same setting the first one counts.
    void add(const Study& study, std::span<const Row> rows);

    /// Rows run as for the paper's tables, in the order of the paper. Pointers are valid until the
    /// next `add`.
    std::vector<Cell> cells() const;

    /// Measures at a setting; null where it is missing or failed.
    const Measures* find(const Case& setting) const;

    /// The same setting but for what decides between edges that are almost equally long: τ or the
    /// box differ by 1e-8 of their size at most, and s_G's sections may be exact.
    std::vector<const Measures*> near_ties(const Case& setting) const;
    /// The same setting with sources up to 5 % closer or farther apart.
    std::vector<const Measures*> near_densities(const Case& setting) const;
    /// The same setting with other depth limits, the deepest last.
    std::vector<const Row*> other_depths(const Case& setting) const;

private:
    struct Entry {
        Row row;
        Box box;
    };
    std::vector<Entry> entries_;
};

}  // namespace controlspace
