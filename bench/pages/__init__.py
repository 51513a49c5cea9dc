# SPDX-License-Identifier: Apache-2.0
# Pages made from results of `controlspace compare`: the paper cell by cell (paper.md) and a page with
# figures (report.html). Needs Debian's python3-numpy, python3-matplotlib and python3-jinja2.
