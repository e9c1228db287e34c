#include "app/verbs/report/report_page.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <map>

#include "app/verbs/report/report_measurements.h"
#include "app/verbs/report/report_methods.h"
#include "app/version.h"
#include "core/base/encoding/base64.h"
#include "core/base/text/text.h"
#include "core/mesh/colours.h"
#include "render/shaders.h"

extern "C" {
extern const unsigned char homolog_report_three[], homolog_report_report_html[], homolog_report_report_css[],
    homolog_report_data_js[], homolog_report_view_js[], homolog_report_gallery_js[], homolog_report_plots_js[],
    homolog_report_report_js[];
extern const std::size_t homolog_report_three_size, homolog_report_report_html_size, homolog_report_report_css_size,
    homolog_report_data_js_size, homolog_report_view_js_size, homolog_report_gallery_js_size,
    homolog_report_plots_js_size, homolog_report_report_js_size;
}

namespace homolog {

namespace {

/// Shapes are kept in the page up to this many bytes; beyond, cases are drawn by the modes that the page has.
constexpr Eigen::Index most_shape_bytes = 6'000'000;

std::string_view part_of_page(const unsigned char* bytes, std::size_t size) {
  return {reinterpret_cast<const char*>(bytes), size - 1};  // without the 0 behind it
}

static_assert(std::endian::native == std::endian::little, "the page's arrays are little-endian");

template <class Number>
std::string array_text(const std::vector<Number>& numbers) {
  return to_base64({reinterpret_cast<const unsigned char*>(numbers.data()), numbers.size() * sizeof(Number)});
}

template <class Values>
std::string floats_text(const Values& values) {
  std::vector<float> numbers;
  numbers.reserve(static_cast<std::size_t>(values.size()));
  for (Eigen::Index k = 0; k < values.size(); ++k) numbers.push_back(static_cast<float>(values.data()[k]));
  return array_text(numbers);
}

/// Two bytes a number where the vertices allow.
std::string faces_text(const Topology& topology) {
  const Triangles& faces = topology.triangles();
  const auto all = [&](auto kind) {
    std::vector<decltype(kind)> numbers;
    for (Eigen::Index k = 0; k < faces.size(); ++k) numbers.push_back(static_cast<decltype(kind)>(faces.data()[k]));
    return array_text(numbers);
  };
  return topology.vertices() <= 65536 ? all(std::uint16_t()) : all(std::uint32_t());
}

Json measures_json(const Measures& measures) {
  Json list = Json::array();
  for (const Measured& one : measures) list.push_back({one.mean, one.standard_error});
  return list;
}

Json optional_number(const std::optional<double>& value) {
  return value ? Json(*value) : Json();
}

/// The modes, a standard deviation each, 3n×k.
Eigen::MatrixXd modes_mm(const ShapeModel& model) {
  return model.basis * model.variances.cwiseSqrt().asDiagonal();
}

Json cases_json(const PageContent& content) {
  Json cases = Json::array();
  for (const PageCase& one : content.cases) {
    Json row{{"name", one.name}, {"group", one.group}, {"in_model", one.shape >= 0}};
    if (one.shape >= 0 && content.model.scores.size() > 0) {
      const Eigen::VectorXd z = content.model.scores.col(one.shape).cwiseQuotient(content.model.variances.cwiseSqrt());
      row["modes"] = std::vector<double>(z.begin(), z.end());
    }
    row["doubt_mm"] = optional_number(one.doubt_mm);
    row["distance_sd"] = optional_number(one.distance_sd);
    cases.push_back(std::move(row));
  }
  return cases;
}

Json page_data(const PageContent& content) {
  const ShapeModel& model = content.model;
  const Mesh mean{model.topology, points_of(model.mean)};
  const double extent = bounds_of(mean.points).diagonal().norm();
  Json data{{"homolog_report", 1},
            {"version", version},
            {"vertices", model.mean.size() / 3},
            {"mean", floats_text(model.mean)},
            {"faces", faces_text(*model.topology)},
            {"face_bytes", model.topology->vertices() <= 65536 ? 2 : 4},
            {"modes", model.modes()},
            {"mode_shapes", floats_text(modes_mm(model))},
            {"variances", std::vector<double>(content.variances.begin(), content.variances.end())},
            {"hues", array_text(vertex_hues(*model.topology))},
            {"glyphs", glyph_vertices(mean, extent / 12)},
            {"arrows", glyph_vertices(mean, extent / 24)},
            {"groups", content.groups()},
            {"cases", cases_json(content)}};
  if (content.doubt_cases > 0) data["doubt_mm"] = floats_text(content.doubt_mm);
  const Eigen::Index bytes = content.shapes.size() * static_cast<Eigen::Index>(sizeof(float));
  if (bytes > 0 && bytes <= most_shape_bytes) data["shapes"] = floats_text(content.shapes);
  data["generalisation_rms"] = measures_json(content.generalisation_rms);
  data["specificity_rms"] = measures_json(content.specificity_rms);
  if (content.recipe) data["measurements"] = measurements_json(content);
  data["scales"] = {{"rising", rising_scale()}, {"diverging", diverging_scale()}, {"doubt", doubt_scale()}};
  data["light"] = std::string(shaders::light_glsl());
  return data;
}

/// JSON that an element of a page can hold: nothing in it can end the element. Old names that are no UTF-8 get marks.
std::string in_element(const Json& data) {
  const std::string text = data.dump(-1, ' ', false, Json::error_handler_t::replace);
  std::string safe;
  safe.reserve(text.size());
  for (const char c : text) {
    if (c == '<')
      safe += "\\u003c";
    else
      safe += c;
  }
  return safe;
}

std::string facts_html(const PageContent& content) {
  const auto fact = [](const std::string& value, const std::string& name) {
    return "<div><dt>" + html_text(name) + "</dt><dd>" + html_text(value) + "</dd></div>";
  };
  const Eigen::Index cases = content.cases_in_model(), vertices = content.model.mean.size() / 3;
  const double spread = std::sqrt(content.variances.sum() / static_cast<double>(vertices));
  std::string html;
  if (cases > 0) html += fact(std::to_string(cases), cases == 1 ? "case" : "cases");
  if (const auto left_out = std::ssize(content.cases) - cases; left_out > 0)
    html += fact(std::to_string(left_out), "left out");
  html += fact(std::to_string(vertices), "vertices");
  html += fact(std::to_string(modes_holding(content.variances, 0.95)), "modes hold 95 %");
  html += fact(fixed_text(spread, 2) + " mm", "spread of a vertex (RMS)");
  if (content.doubt_cases > 0)
    html += fact(fixed_text(std::sqrt(content.doubt_mm.cwiseAbs2().mean()), 2) + " mm", "doubt of a vertex (RMS)");
  return html;
}

std::string modes_table_html(const PageContent& content) {
  const double total = content.variances.sum();
  const double vertices = static_cast<double>(content.model.mean.size()) / 3;
  double held = 0;
  std::string rows;
  for (Eigen::Index m = 0; m < content.model.modes(); ++m) {
    held += content.variances[m];
    rows += "<tr><th scope=\"row\">" + std::to_string(m + 1) + "</th><td>" +
            fixed_text(100 * content.variances[m] / total, 1) + " %</td><td>" + fixed_text(100 * held / total, 1) +
            " %</td><td>" + fixed_text(std::sqrt(content.variances[m] / vertices), 2) + " mm</td></tr>\n";
  }
  return rows;
}

/// A column of the table of cases: its title, what it means, and the text of a case.
struct CaseColumn {
  const char* title;
  const char* tip;
  bool is_word;
  std::string (*text)(const PageCase& one);
};

std::string number_or_nothing(const std::optional<double>& value, int digits) {
  return value ? fixed_text(*value, digits) : std::string();
}

const std::array case_columns{
    CaseColumn{"Group", "", true, [](const PageCase& one) { return one.group; }},
    CaseColumn{"Distance, SD", "Mahalanobis distance from the model of the other cases, in the first modes", false,
               [](const PageCase& one) { return number_or_nothing(one.distance_sd, 2); }},
    CaseColumn{"Centroid size, mm", "Before the shapes were aligned", false,
               [](const PageCase& one) { return number_or_nothing(one.size_mm, 0); }},
    CaseColumn{"Doubt, mm", "Root mean square over the vertices", false,
               [](const PageCase& one) { return number_or_nothing(one.doubt_mm, 2); }},
    CaseColumn{"Note", "", true,
               [](const PageCase& one) { return one.excluded.empty() ? one.doubt : "left out: " + one.excluded; }}};

/// The table of cases; a column in which no case has anything is not there.
std::string cases_table_html(const PageContent& content) {
  std::vector<CaseColumn> columns;
  for (const CaseColumn& column : case_columns)
    if (std::any_of(content.cases.begin(), content.cases.end(),
                    [&](const PageCase& one) { return !column.text(one).empty(); }))
      columns.push_back(column);
  std::string html = "<thead><tr><th scope=\"col\">Case</th>";
  for (const CaseColumn& column : columns)
    html += std::string("<th scope=\"col\"") + (column.is_word ? " class=\"word\"" : "") +
            (*column.tip != 0 ? " title=\"" + html_text(column.tip) + "\"" : "") + ">" + column.title + "</th>";
  html += "</tr></thead>\n<tbody>\n";
  for (std::size_t k = 0; k < content.cases.size(); ++k) {
    const PageCase& one = content.cases[k];
    html += "<tr data-case=\"" + std::to_string(k) + "\"" + (one.shape < 0 ? " class=\"excluded\"" : "") +
            "><th scope=\"row\">" + html_text(one.name) + "</th>";
    for (const CaseColumn& column : columns)
      html +=
          std::string("<td") + (column.is_word ? " class=\"word\"" : "") + ">" + html_text(column.text(one)) + "</td>";
    html += "</tr>\n";
  }
  return html + "</tbody>";
}

/// What the table's figures mean that its titles do not say.
std::string cases_note_html(const PageContent& content) {
  std::string note;
  if (content.distance_modes > 0)
    note += "Distance: the Mahalanobis distance from the model of the other cases, in the first " +
            std::to_string(content.distance_modes) + (content.distance_modes == 1 ? " mode. " : " modes. ");
  if (content.doubt_cases > 0) note += "Doubt: the root mean square over the vertices of what the fit says.";
  return note;
}

std::string picture_html(const std::string& png) {
  if (png.empty()) return {};
  const auto* bytes = reinterpret_cast<const unsigned char*>(png.data());
  return "<img alt=\"The first modes of the model, a row each: at minus 3 standard deviations, the mean, and at plus "
         "3\" "
         "src=\"data:image/png;base64," +
         to_base64({bytes, png.size()}) + "\">";
}

/// The text with every {{name}} replaced by its value. A value is taken as it is.
std::string filled(std::string_view text, const std::map<std::string, std::string, std::less<>>& values) {
  std::string page;
  while (true) {
    const auto open = text.find("{{"), close = text.find("}}", open);
    if (open == text.npos || close == text.npos) break;
    page += text.substr(0, open);
    page += values.at(std::string(text.substr(open + 2, close - open - 2)));
    text = text.substr(close + 2);
  }
  return page.append(text);
}

}  // namespace

std::string report_page(const PageContent& content, const std::string& picture_png) {
  std::string script;
  for (const std::string_view part : {part_of_page(homolog_report_data_js, homolog_report_data_js_size),
                                      part_of_page(homolog_report_view_js, homolog_report_view_js_size),
                                      part_of_page(homolog_report_gallery_js, homolog_report_gallery_js_size),
                                      part_of_page(homolog_report_plots_js, homolog_report_plots_js_size),
                                      part_of_page(homolog_report_report_js, homolog_report_report_js_size)})
    script += part;
  return filled(part_of_page(homolog_report_report_html, homolog_report_report_html_size),
                {{"title", html_text(content.title)},
                 {"style", std::string(part_of_page(homolog_report_report_css, homolog_report_report_css_size))},
                 {"facts", facts_html(content)},
                 {"picture", picture_html(picture_png)},
                 {"modes", modes_table_html(content)},
                 {"measurements", measurements_html(content)},
                 {"cases", cases_table_html(content)},
                 {"cases_note", cases_note_html(content)},
                 {"methods", methods_html(content)},
                 {"command", html_text(content.command)},
                 {"version", version},
                 {"data", in_element(page_data(content))},
                 {"three", std::string(part_of_page(homolog_report_three, homolog_report_three_size))},
                 {"script", script}});
}

}  // namespace homolog
