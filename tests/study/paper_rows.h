#pragma once

#include <functional>

#include "study/paper.h"
#include "study/sample_rows.h"

namespace controlspace {

/// The case of a row of the paper's tables.
inline Case case_of(const PaperRow& paper) {
    Case c = published_case();
    c.structure = paper.structure;
    c.split = paper.split;
    c.sources.rho = paper.rho;
    c.tau = paper.tau;
    c.max_depth = paper.split ? 42 : 14;
    return c;
}

/// A row of ours that has measured what the paper prints.
inline Row row_of(const PaperRow& paper) {
    Row row = sample_row(case_of(paper));
    Measures& m = *row.measures;
    m.footprint.bytes_published = static_cast<std::size_t>(std::llround(paper.size_mb * 1e6));
    m.footprint.bytes_payload = *m.footprint.bytes_published;
    m.footprint.bytes_topology = m.footprint.bytes_auxiliary = 0;
    m.insert_s = paper.creation_s;
    m.gradation_s = 0;
    m.access_random.samples_ns = {paper.access_us * 1e3};
    m.accuracy.max = paper.delta_r_max;
    return row;
}

/// All of the paper's rows as if measured here, each changed by `change`.
inline std::vector<Row> rows_of_paper(const std::function<void(Row&)>& change = {}) {
    std::vector<Row> rows;
    for (const PaperRow& paper : paper_rows()) {
        rows.push_back(row_of(paper));
        if (change) change(rows.back());
    }
    return rows;
}

}  // namespace controlspace
