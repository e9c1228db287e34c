#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <tuple>

#include "app/pictures/plates.h"
#include "app/verbs/model/model_part.h"
#include "app/verbs/picture/picture_verb.h"
#include "app/verbs/statistics/test_cases.h"
#include "core/base/files/file_stem.h"
#include "core/base/text/text.h"
#include "core/model/files/statismo.h"
#include "core/model/shapes/shape_files.h"
#include "core/statistics/design.h"
#include "core/volume/volume_io.h"

// The verbs `picture map`, `groups`, `score` and `plot`: what was measured, for print.

namespace homolog {

namespace fs = std::filesystem;

namespace {

struct PlateVerb {
  std::shared_ptr<PictureVerb> picture;
  std::string property, term, by;
  fs::path table, model;
  std::vector<double> range;
  std::vector<fs::path> against;
  TestCasesAsked cases;
  TablePlot plot;
};

/// All values of vertices that a mesh's file has, by name.
std::map<std::string, VertexScalars> values_in(const MeshFile& mesh) {
  std::map<std::string, VertexScalars> values = mesh.arrays;
  if (mesh.doubt_mm) values["doubt_mm"] = *mesh.doubt_mm;
  if (mesh.outlier) values["outlier"] = *mesh.outlier;
  if (mesh.stiffness) values["stiffness"] = *mesh.stiffness;
  return values;
}

/// A column of a table with a row a vertex, as `test --csv` writes it; NaN where it has no row. Errors: no such column,
/// several terms, a row that is no vertex of the mesh, a table of a mesh with fewer vertices.
Result<VertexScalars> values_in(const TextTable& table, const PlateVerb& verb, Eigen::Index vertices) {
  const auto column = [&](const std::string& name) {
    return static_cast<std::size_t>(std::find(table.columns.begin(), table.columns.end(), name) -
                                    table.columns.begin());
  };
  const std::size_t vertex = column("vertex"), value = column(verb.property), term = column("term");
  const std::string file = verb.table.string();
  for (const auto& [at, name] : {std::pair(vertex, std::string("vertex")), std::pair(value, verb.property)})
    if (at == table.columns.size())
      return fail(file, "has no column " + name + "; it has " + listed(table.columns, ", "));
  if (!verb.term.empty() && term == table.columns.size()) return fail(file, "has no column term; leave out --term");
  std::set<std::string> terms;
  std::set<Eigen::Index> named;
  VertexScalars values = VertexScalars::Constant(vertices, std::numeric_limits<double>::quiet_NaN());
  for (std::size_t row = 0; row < table.rows.size(); ++row) {
    const auto& cells = table.rows[row];
    if (term < table.columns.size()) terms.insert(cells[term]);
    if (term < table.columns.size() && !verb.term.empty() && cells[term] != verb.term) continue;
    const auto number = as_number<Eigen::Index>(cells[vertex]);
    if (!number || *number < 0 || *number >= vertices)
      return fail(file, "names a vertex in line " + std::to_string(table.lines[row]) +
                            " that the mesh does not have; "
                            "its vertices are 0 to " +
                            std::to_string(vertices - 1));
    named.insert(*number);
    if (const auto known = as_number<double>(cells[value])) values[*number] = *known;
  }
  const std::vector<std::string> names(terms.begin(), terms.end());
  if (verb.term.empty() ? terms.size() > 1 : !terms.contains(verb.term))
    return fail(file, "has the terms " + listed(names, " and ") + "; name one with --term");
  // One that begins as a mesh does and ends before is of another mesh; one with gaps is of some vertices.
  if (const auto rows = std::ssize(named); rows > 1 && rows < vertices && *named.rbegin() == rows - 1)
    return fail(file, "is of a mesh of " + std::to_string(rows) + " vertices, and " +
                          verb.picture->in.front().string() + " has " + std::to_string(vertices) +
                          "; give the table of this mesh");
  return values;
}

Result<Report> of_map(const PlateVerb& verb) {
  const fs::path& file = verb.picture->in.front();
  const auto mesh = is_model_name(file) ? mesh_of_model(file, verb.picture->structure, {}) : read_mesh_file(file);
  if (!mesh) return fail(mesh.error());
  if (mesh->triangles.rows() == 0) return fail(file.string(), "has points only; a picture needs faces");
  const auto sound = sound_mesh(*mesh);
  if (!sound) return fail(file.string(), sound.error().what);
  VertexScalars values;
  if (!verb.table.empty()) {
    const auto table = read_text_table(verb.table);
    if (!table) return fail(table.error());
    auto read = values_in(*table, verb, mesh->points.rows());
    if (!read) return fail(read.error());
    values = std::move(*read);
  } else {
    const auto known = values_in(*mesh);
    const auto found = known.find(verb.property);
    std::vector<std::string> names;
    for (const auto& [name, some] : known) names.push_back(name);
    if (found == known.end())
      return fail(file.string(), "has no property " + verb.property + " of its vertices; it has " +
                                     (names.empty() ? "none, so name a table with --values" : listed(names, ", ")));
    values = found->second;
  }
  return write_plate(map_page(*sound, values, verb.property, verb.range, montage_options(*verb.picture)),
                     *verb.picture);
}

/// The group of each case by a column of what is known of them.
Result<std::vector<std::string>> groups_by(const TestCases& cases, const std::string& by) {
  const auto column = cases.table.column(by);
  if (!column) return fail(by, "is no column that names groups");
  std::vector<std::string> groups;
  for (const std::size_t row : cases.rows) groups.push_back(cases.table.cells[row][*column]);
  return groups;
}

struct Grouped {
  ShapeMatrix shapes;  ///< aligned
  std::shared_ptr<const Topology> topology;
  std::vector<std::string> of;     ///< the group of each shape
  std::vector<std::string> names;  ///< of the groups, in order
  std::vector<std::string> warnings;
};

Result<Grouped> grouped_by_column(const PlateVerb& verb, Progress& progress) {
  TestCasesAsked asked = verb.cases;
  asked.formula = {{Variable::By::itself, "shape"}, {{{Variable::By::factor, verb.by}}}};
  auto cases = read_test_cases(asked, progress);
  if (!cases) return fail(cases.error());
  auto groups = groups_by(*cases, verb.by);
  if (!groups) return fail(groups.error());
  const auto levels = coded_groups(verb.by, *groups);
  if (!levels) return fail(levels.error());
  return Grouped{std::move(cases->shapes), cases->topology, std::move(*groups), levels->levels,
                 std::move(cases->warnings)};
}

/// The folder of a list of files, as the name of its group.
std::string name_of_list(const std::vector<fs::path>& files, const char* otherwise) {
  if (files.size() > 1) return otherwise;
  const fs::path one = files.front().has_filename() ? files.front() : files.front().parent_path();
  return file_stem(one.string());
}

Result<Grouped> grouped_by_list(const PlateVerb& verb, Progress& progress) {
  const auto second = shape_sources(verb.against);
  if (!second) return fail(second.error());
  std::set<std::string> in_second;
  for (const ShapeSource& source : *second) in_second.insert(source.file.string());
  std::vector<fs::path> files = verb.cases.shapes.files;
  files.insert(files.end(), verb.against.begin(), verb.against.end());
  auto read = read_training_set(files, verb.cases.shapes.reading, &progress);
  if (!read) return fail(read.error());
  Grouped grouped{std::move(read->set.shapes), read->set.topology, {}, {}, std::move(read->warnings)};
  align(grouped.shapes, verb.cases.shapes.alignment());
  grouped.names = {name_of_list(verb.cases.shapes.files, "first"), name_of_list(verb.against, "second")};
  if (grouped.names[0] == grouped.names[1]) grouped.names = {"first", "second"};
  for (const std::string& name : read->set.names) {
    const bool is_second = in_second.contains(name) || in_second.contains(name.substr(0, name.find(" structure "))) ||
                           in_second.contains(name.substr(0, name.find(" frame ")));
    grouped.of.push_back(grouped.names[is_second ? 1 : 0]);
  }
  return grouped;
}

Result<Report> of_groups(const PlateVerb& verb, Progress& progress) {
  const auto grouped = verb.by.empty() ? grouped_by_list(verb, progress) : grouped_by_column(verb, progress);
  if (!grouped) return fail(grouped.error());
  const std::string subject = verb.picture->in.front().string();
  if (!grouped->topology) return fail(subject, "holds points only; a picture needs faces, so give meshes");
  constexpr std::size_t most_groups = 6;
  if (grouped->names.size() > most_groups)
    return fail("--by " + verb.by, "names " + std::to_string(grouped->names.size()) +
                                       " groups, and a page has room for 6; name a column with fewer");
  std::vector<GroupMean> means;
  for (const std::string& name : grouped->names) {
    GroupMean group{name, std::count(grouped->of.begin(), grouped->of.end(), name), {}};
    if (group.shapes == 0) return fail(subject, "leaves no shape in the group " + name);
    Eigen::VectorXd sum = Eigen::VectorXd::Zero(grouped->shapes.rows());
    for (std::size_t k = 0; k < grouped->of.size(); ++k)
      if (grouped->of[k] == name) sum += grouped->shapes.col(static_cast<Eigen::Index>(k));
    group.mean = points_of(Eigen::VectorXd(sum / static_cast<double>(group.shapes)));
    means.push_back(std::move(group));
  }
  auto report =
      write_plate(groups_page(means, grouped->topology, verb.range, montage_options(*verb.picture)), *verb.picture);
  if (!report) return report;
  Json groups = Json::array();
  for (const GroupMean& group : means) groups.push_back({{"name", group.name}, {"shapes", group.shapes}});
  report->values["groups"] = std::move(groups);
  report->warnings = grouped->warnings;
  return report;
}

Result<Report> of_score(const PlateVerb& verb, Progress& progress) {
  const auto model = read_model(verb.model);
  if (!model) return fail(model.error());
  const fs::path& file = verb.picture->in.front();
  std::error_code ignored;
  if (!is_mesh_name(file) && fs::is_regular_file(file, ignored) && looks_like_volume(file))
    return fail(file.string(), "is an image or a label map; give the mesh that score -o writes of it");
  const auto sources = shape_sources(verb.picture->in);
  if (!sources) return fail(sources.error());
  std::optional<ReadShape> subject;
  const auto take = [&](ReadShape shape) -> Result<void> {
    if (subject) return fail(shape.name, "is a second subject; a picture shows one");
    subject = std::move(shape);
    return {};
  };
  if (const auto read = read_shapes(*sources, {}, take, &progress); !read) return fail(read.error());
  const MeshFile& mesh = *subject->mesh;
  const auto score = score_shape(*model, mesh.points, mesh.doubt_mm ? *mesh.doubt_mm : VertexScalars());
  if (!score) return fail(subject->name, score.error().what);
  auto page = score_page(*model, *score, file_stem(subject->name), verb.range, montage_options(*verb.picture));
  if (!page && page.error().subject.empty()) return fail(verb.model.string(), page.error().what);
  auto report = write_plate(page, *verb.picture);
  if (report) report->values["distance"] = score->distance;
  return report;
}

Result<Report> of_plot(const PlateVerb& verb) {
  const fs::path& file = verb.picture->in.front();
  const double width_mm = montage_options(*verb.picture).width_mm;
  if (is_model_name(file) && !verb.plot.x.empty())
    return fail(file.string(), "is a model, so --x and --y have no effect; leave them out");
  if (!is_model_name(file)) {
    auto table = read_text_table(file);
    if (!table) return fail(table.error());
    const std::string encoding = mend_encoding(*table);
    if (auto mended = mend_decimal_commas(file, *table); !mended) return fail(mended.error());
    const bool is_measures = verb.plot.x.empty();
    auto report = write_plate(is_measures ? measure_plots(*table, width_mm) : table_plot(*table, verb.plot, width_mm),
                              *verb.picture);
    if (report && !encoding.empty()) report->warnings.push_back(file.string() + ": " + encoding);
    if (is_measures) return report;
    if (const std::size_t without = rows_without_values(*table, verb.plot); report && without > 0)
      report->warnings.push_back(file.string() + ": " + std::to_string(without) +
                                 (without == 1 ? " row lacks a value and is" : " rows lack a value and are") +
                                 " left out");
    return report;
  }
  const auto model = read_model(file);
  if (!model) return fail(model.error());
  return write_plate(model_plots(*model, width_mm), *verb.picture);
}

void add_range(CLI::App& verb, PlateVerb& plate) {
  verb.add_option("--range", plate.range, "LOW,HIGH of the colours (default: round numbers that hold all values)")
      ->delimiter(',')
      ->expected(2);
}

/// What all plates take.
void add_plate_options(CLI::App& verb, PictureVerb& options) {
  verb.add_option("-o,--output", options.out, "The picture to write: .svg, .pdf or .png")->required();
  add_width(verb, options);
}

/// What the callbacks check; a plate is always for print.
void check_plate(PlateVerb& plate) {
  if (plate.picture->width_mm == 0) plate.picture->width_mm = usual_page_mm;
  if (!plate.range.empty() && !(plate.range[0] < plate.range[1] && std::isfinite(plate.range[1] - plate.range[0])))
    throw CLI::ValidationError("--range", "needs LOW,HIGH with the lower number first");
}

}  // namespace

MontageOptions montage_options(const PictureVerb& verb) {
  MontageOptions options;
  if (verb.is_for_print())
    options = print_options(verb.width_mm > 0 ? verb.width_mm : usual_page_mm);
  else
    std::tie(options.width_px, options.height_px) = parsed_size(verb.size).value();
  options.from = direction_from_name(verb.view).value();
  options.glyph_spacing_mm = verb.glyph_spacing_mm;
  options.transparent = verb.transparent || verb.ground == "transparent";
  if (!verb.ground.empty()) options.light = verb.ground == "light";
  options.captions |= verb.captions;
  return options;
}

Error about(const PictureVerb& verb, Error error) {
  if (error.subject.empty()) error.subject = verb.in.front().string();
  return error;
}

Result<Report> write_plate(const Result<Page>& page, const PictureVerb& verb) {
  if (!page) return fail(about(verb, page.error()));
  if (auto written = write_page(*page, verb.out); !written) return fail(written.error());
  const auto px = [&](double mm) { return static_cast<int>(std::lround(mm / 25.4 * page->dpi)); };
  Report report{{{"size", Json::array({px(page->width_mm), px(page->height_mm)})}}, {}, {verb.out}};
  if (verb.is_for_print()) report.values.update({{"width_mm", page->width_mm}, {"height_mm", page->height_mm}});
  return report;
}

CLI::Option* add_width(CLI::App& verb, PictureVerb& options) {
  return verb
      .add_option("--width-mm", options.width_mm,
                  "For print at 300 dpi: how wide the page is, 85 for one column (default of .svg and .pdf: 170)")
      ->check(CLI::Range(40.0, 400.0));
}

void add_view(CLI::App& verb, PictureVerb& options) {
  verb.add_option("--view", options.view,
                  "Where the 3D view looks from: anterior, posterior, left, right, superior, inferior or x,y,z")
      ->check([](const std::string& text) {
        const auto direction = direction_from_name(text);
        return direction ? std::string() : "\"" + text + "\" " + direction.error().what;
      });
}

bool is_gif_name(const fs::path& path) {
  return lower_case(path.extension().string()) == ".gif";
}

void add_plates(CLI::App& picture, const std::shared_ptr<PictureVerb>& options, CommandLine& asked) {
  auto plate = std::make_shared<PlateVerb>();
  plate->picture = options;
  const auto runs = [&asked, plate](CLI::App* verb, auto work) {
    verb->callback([&asked, plate, work] {
      check_plate(*plate);
      asked.run = [plate, work](Progress& progress) { return work(*plate, progress); };
    });
  };
  CLI::App* map = add_verb(picture, "map", "A mesh coloured by a property of its vertices, from two sides");
  map->add_option("MESH", options->in, "The mesh, or a model for its mean")->required()->expected(1);
  map->add_option("--property", plate->property, "Its property, as z or doubt_mm, or a column of --values")->required();
  auto* table = map->add_option("--values", plate->table, "A table with a row a vertex, as test --csv writes it");
  map->add_option("--term", plate->term, "Of that table the rows of this term")->needs(table);
  add_range(*map, *plate);
  add_plate_options(*map, *options);
  add_view(*map, *options);
  runs(map, [](const PlateVerb& verb, Progress&) { return of_map(verb); });

  CLI::App* groups = add_verb(picture, "groups", "The means of groups of shapes, and where they differ");
  add_set_options(*groups, plate->cases.shapes);
  auto* covariates = groups->add_option("--covariates", plate->cases.covariates,
                                        "A table (.csv) of the cases (default: what the study knows)");
  auto* by = groups->add_option("--by", plate->by, "The column that names the groups");
  covariates->needs(by);
  groups->add_option("--against", plate->against, "The shapes of the other group")->excludes(by);
  add_range(*groups, *plate);
  add_plate_options(*groups, *options);
  add_view(*groups, *options);
  groups->callback([&asked, plate] {
    if (plate->by.empty() && plate->against.empty())
      throw CLI::ValidationError("groups", "are not told; name their column with --by, or other shapes with --against");
    check_plate(*plate);
    plate->picture->in = plate->cases.shapes.files;
    asked.run = [plate](Progress& progress) { return of_groups(*plate, progress); };
  });

  CLI::App* score = add_verb(picture, "score", "A subject against the shapes of a model");
  score->add_option("SHAPE", options->in, "The subject: a mesh of the model's numbering, or a case")
      ->required()
      ->expected(1);
  score->add_option("--model", plate->model, "The model (.h5, .h5.json)")->required();
  add_range(*score, *plate);
  add_plate_options(*score, *options);
  add_view(*score, *options);
  runs(score, [](const PlateVerb& verb, Progress& progress) { return of_score(verb, progress); });

  CLI::App* plot =
      add_verb(picture, "plot", "The variances and the training shapes of a model, its measures, or a table's columns");
  plot->add_option("FILE", options->in,
                   "A model (.h5, .h5.json), a table that evaluate --csv wrote, or any with --x, --y")
      ->required()
      ->expected(1);
  auto* x = plot->add_option("--x", plate->plot.x, "The column of a table that goes across: numbers, or groups");
  auto* y = plot->add_option("--y", plate->plot.y, "The column of numbers that goes up")->needs(x);
  x->needs(y);
  plot->add_option("--by", plate->plot.by, "The column of groups, each a colour")->needs(x);
  add_plate_options(*plot, *options);
  runs(plot, [](const PlateVerb& verb, Progress&) { return of_plot(verb); });
}

}  // namespace homolog
