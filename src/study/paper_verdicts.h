#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "study/paper_evidence.h"

namespace controlspace {

/// What a cell of ours says of the paper's.
enum class Verdict {
    equal,           ///< to the printed digit
    explained,       ///< differs, for a reason that an experiment shows
    not_comparable,  ///< seconds of another machine, ticks of another clock
    unexplained,     ///< differs, and no experiment at hand shows why
    failed,          ///< was not measured
};
std::string_view to_string(Verdict verdict);

struct CellVerdict {
    PaperEvidence::Cell cell;
    Verdict verdict;
    std::string reason;  ///< one sentence with the numbers that decide; empty where equal
};

/// Whether `ours`, rounded to the two decimals of the paper's tables, is what the paper prints.
bool equals_printed(double ours, double paper);

/// Whether a fault of the published program touches the structure in all tables: K_oLB (balance),
/// K_V and K_oV (vertices that are not shared).
bool is_touched_by_fault(std::string_view structure);

/// Control nodes that the paper's size holds, if its tree has the elements of ours: its Table 1
/// counts each of them with 104 bytes. Trees with vertices only.
double nodes_in_published_size(const Measures& ours, const PaperRow& paper);

/// The same structure at the same setting, with another structure's id: K_oL beside K_oLB.
Case with_structure(Case setting, std::string_view id);

/// A verdict on each cell of a table, in the order of `evidence.cells()`. The rules, tried in this
/// order, by table and structure:
///   Tables 2, 3       not comparable
///   any               equal, if our value rounds to the paper's
///   K_oLB             balance: ours is below 2 x K_oL's size, the paper's above 3 x its own, and
///                     (Table 4) ours is not less accurate than K_oL
///   s_G, s_M          ties: cases that choose otherwise among edges of almost equal length differ
///                     among each other by as much, or reach the paper's value
///   K_V, K_oV         shared vertices: the paper's size holds over 5 % more control nodes than
///                     there are places, and (Table 4) ours is more accurate
///   K_oL, Table 4     links: all faces instead of one leaf a face change ours by as much
///   any, Table 4      scatter: the paper's value lies within those that ours takes when the
///                     sources are a little closer or farther apart
/// Whatever is left is unexplained.
std::vector<CellVerdict> judge(const PaperEvidence& evidence, PaperTable table);

}  // namespace controlspace
