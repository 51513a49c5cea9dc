#include "report/html.h"

#include <fmt/format.h>

#include <cstdint>

namespace controlspace {
namespace {

std::string base64(std::string_view bytes) {
    constexpr std::string_view digits =
        "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string text;
    text.reserve((bytes.size() + 2) / 3 * 4);
    for (std::size_t i = 0; i < bytes.size(); i += 3) {
        std::uint32_t group = 0;
        for (std::size_t k = 0; k < 3; ++k) {
            const bool there = i + k < bytes.size();
            group = group << 8 | (there ? static_cast<unsigned char>(bytes[i + k]) : 0u);
        }
        for (std::size_t k = 0; k < 4; ++k) {
            const bool there = i + k <= bytes.size();
            text += there ? digits[group >> (18 - 6 * k) & 63u] : '=';
        }
    }
    return text;
}

constexpr std::string_view style = R"(
body { font: 15px/1.5 system-ui, sans-serif; margin: 2rem auto; max-width: 100rem; padding: 0 1rem;
       color: #1a1a1a; background: #fff }
nav a { margin-right: 1rem }
.figures { display: flex; flex-wrap: wrap; gap: 1.5rem }
figure { margin: 0; max-width: 100% }
figure img { max-width: 100%; height: auto; border: 1px solid #ddd }
figcaption { max-width: 46rem; font-size: 0.9em; color: #444 }
figcaption b { color: #1a1a1a }
code { overflow-wrap: anywhere }
.table { overflow-x: auto }
table { border-collapse: collapse; font-size: 0.9em; font-variant-numeric: tabular-nums }
caption { text-align: left; padding: 0.3em 0; color: #444 }
th, td { padding: 0.15em 0.6em; border-bottom: 1px solid #ddd; text-align: right;
         vertical-align: top }
th { position: sticky; top: 0; background: #f3f3f3 }
th button { all: unset; cursor: pointer; font-weight: bold }
th button:focus-visible { outline: 2px solid #0072b2 }
th[aria-sort=ascending] button::after { content: " \25b2" }
th[aria-sort=descending] button::after { content: " \25bc" }
.left { text-align: left }
)";

// Neither < nor an ampersand: the page is XML too.
constexpr std::string_view script = R"(
function sort_by(button) {
  const head = button.parentElement, table = head.closest("table"), body = table.tBodies[0];
  const up = head.getAttribute("aria-sort") !== "ascending", column = head.cellIndex;
  for (const other of head.parentElement.cells) other.removeAttribute("aria-sort");
  head.setAttribute("aria-sort", up ? "ascending" : "descending");
  const text = row => row.cells[column].textContent, number = row => parseFloat(text(row));
  const is_text = head.className === "left";
  const order = (a, b) => {
    if (is_text) return text(a).localeCompare(text(b), undefined, {numeric: true});
    const x = number(a), y = number(b);
    return isNaN(x) ? (isNaN(y) ? 0 : 1) : isNaN(y) ? -1 : up ? x - y : y - x;
  };
  const rows = Array.from(body.rows).sort(is_text ? (a, b) => up ? order(a, b) : order(b, a) : order);
  body.append(...rows);
}
)";

}  // namespace

std::string html_text(std::string_view text) {
    std::string safe;
    for (const char c : text) {
        switch (c) {
            case '&':
                safe += "&amp;";
                break;
            case '<':
                safe += "&lt;";
                break;
            case '>':
                safe += "&gt;";
                break;
            case '"':
                safe += "&quot;";
                break;
            default:
                safe += static_cast<unsigned char>(c) < 0x20 ? ' ' : c;
        }
    }
    return safe;
}

std::string html_figure(const Figure& figure, std::string_view bytes) {
    return fmt::format(
        "<figure id=\"{0}\">\n<img src=\"data:image/{7};base64,{1}\" width=\"{2}\" "
        "height=\"{3}\" alt=\"{4}\" />\n<figcaption><b>{4}</b><br />{5}<br />Made by "
        "<code>{6}</code>; report-pictures/{0}.svg, .png, .gp</figcaption>\n</figure>\n",
        html_text(figure.name), base64(bytes), figure.width, figure.height, html_text(figure.title),
        html_text(figure.caption), html_text(figure.made_by), figure.raster ? "png" : "svg+xml");
}

std::string html_table(const TextTable& table) {
    const auto side = [&](std::size_t column) {
        return table.columns[column].align == Align::left ? " class=\"left\"" : "";
    };
    std::string text =
        fmt::format("<h3>{}</h3>\n<div class=\"table\"><table>\n", html_text(table.title));
    if (!table.note.empty()) text += fmt::format("<caption>{}</caption>\n", html_text(table.note));
    text += "<thead><tr>";
    for (std::size_t i = 0; i < table.columns.size(); ++i) {
        text +=
            fmt::format("<th scope=\"col\"{}><button onclick=\"sort_by(this)\">{}</button></th>",
                        side(i), html_text(table.columns[i].header));
    }
    text += "</tr></thead>\n<tbody>\n";
    for (const auto& row : table.rows) {
        text += "<tr>";
        for (std::size_t i = 0; i < row.size(); ++i) {
            text += fmt::format("<td{}>{}</td>", side(i), html_text(row[i]));
        }
        text += "</tr>\n";
    }
    return text + "</tbody></table></div>\n";
}

std::string html_page(std::string_view title, std::string_view body) {
    return fmt::format(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\" />\n"
        "<meta name=\"viewport\" content=\"width=device-width\" />\n<title>{0}</title>\n"
        "<style>{1}</style>\n<script>{2}</script>\n</head>\n<body>\n<h1>{0}</h1>\n{3}</body>\n"
        "</html>\n",
        html_text(title), style, script, body);
}

}  // namespace controlspace
