#include <algorithm>
#include <charconv>
#include <filesystem>
#include <optional>
#include <tuple>
#include <utility>
#include <vector>

#include "app/editor/window/editor_picture.h"
#include "app/editor/window/picture_captions.h"
#include "app/pictures/pictures.h"
#include "app/verbs/model_part.h"
#include "app/verbs/verb.h"
#include "core/base/file_stem.h"
#include "core/base/picture_io.h"
#include "core/mesh/mirror.h"
#include "core/model/joint_set.h"
#include "core/model/shape_files.h"
#include "core/model/structure_files.h"
#include "core/model/study.h"
#include "core/session/case_file.h"
#include "render/offscreen.h"

namespace homolog {

namespace fs = std::filesystem;

namespace {

struct PictureVerb {
  std::vector<fs::path> in;
  fs::path out;
  std::string size = "1280x960", view = "anterior";
  double glyph_spacing_mm = 0;
  bool transparent = false, all_frames = false, captions = false;
  std::string ground, only;             ///< empty: as it always was
  std::vector<std::string> structures;  ///< joined; empty: shapes of one
  std::string structure;                ///< of those this one alone; empty: all
  int modes = 2;
};

const std::vector<std::string> grounds{"dark", "light", "transparent"};

constexpr int largest_side_px = 16384;
const std::vector<std::string> view_names{"axial", "sagittal", "coronal", "3d"};  // as all_views
const std::vector<std::string> study_names{"gallery", "modes"};

/// {width, height}; nullopt where the text is no size.
std::optional<std::pair<int, int>> parsed_size(const std::string& text) {
  const char *begin = text.data(), *end = begin + text.size();
  int width = 0, height = 0;
  const auto first = std::from_chars(begin, end, width);
  if (first.ec != std::errc() || first.ptr == end || *first.ptr != 'x') return std::nullopt;
  if (std::from_chars(first.ptr + 1, end, height).ptr != end) return std::nullopt;
  if (std::min(width, height) < 64 || std::max(width, height) > largest_side_px) return std::nullopt;
  return std::pair(width, height);
}

void add_size(CLI::App& verb, std::string& size) {
  verb.add_option("--size", size, "WIDTHxHEIGHT in pixels")->check([](const std::string& text) {
    return parsed_size(text) ? std::string() : text + " is not WIDTHxHEIGHT in pixels between 64 and 16384";
  });
}

/// The command line was checked when it was parsed.
MontageOptions montage_options(const PictureVerb& verb) {
  MontageOptions options;
  std::tie(options.width_px, options.height_px) = parsed_size(verb.size).value();
  options.from = direction_from_name(verb.view).value();
  options.glyph_spacing_mm = verb.glyph_spacing_mm;
  options.transparent = verb.transparent || verb.ground == "transparent";
  options.light = verb.ground == "light";
  options.captions = verb.captions;
  return options;
}

/// The part of the window that `only` names, as the window's own export makes it.
std::optional<PictureOptions> part_of(const PictureVerb& verb) {
  if (verb.only.empty()) return std::nullopt;
  PictureOptions part;
  std::tie(part.width, part.height) = parsed_size(verb.size).value();
  part.transparent = verb.ground == "transparent";
  part.light = verb.ground == "light";
  part.captions = verb.captions;
  const auto view = std::find(view_names.begin(), view_names.end(), verb.only);
  if (view != view_names.end())
    part.view = all_views[static_cast<std::size_t>(view - view_names.begin())];
  else
    part.study = verb.only == "modes" ? StudyPicture::modes : StudyPicture::gallery;
  return part;
}

Result<Report> write(Result<MadePicture> made, const PictureVerb& verb) {
  if (!made) {
    Error error = made.error();
    if (error.subject.empty()) error.subject = verb.in.front().string();
    return fail(std::move(error));
  }
  if (verb.captions) {
    std::vector<PictureCaption> captions;
    for (const PictureCell& cell : made->cells)
      captions.push_back({{static_cast<float>(cell.x), static_cast<float>(cell.y), static_cast<float>(cell.width),
                           static_cast<float>(cell.height)},
                          cell.name,
                          cell.mm_per_px});
    const bool light_ground = verb.ground == "light";
    if (auto put = write_captions(made->picture, captions, light_ground); !put) return fail(put.error());
  }
  if (auto written = write_picture(made->picture, verb.out); !written) return fail(written.error());
  return Report{{{"glyphs", made->glyphs}, {"size", Json::array({made->picture.width, made->picture.height})}}, {}};
}

Result<Report> correspondence(const PictureVerb& verb, Progress& progress) {
  const auto sources = shape_sources(verb.in);
  if (!sources) return fail(sources.error());
  std::vector<Mesh> shapes;
  std::vector<std::string> names;
  std::string first;
  const auto take = [&](const ReadShape& shape) -> Result<void> {
    const std::string& name = shape.name;
    const MeshFile& mesh = *shape.mesh;
    if (mesh.triangles.rows() == 0) return fail(name, "has points only; a picture needs faces, so give meshes");
    names.push_back(file_stem(name));
    if (shapes.empty()) {
      auto topology = Topology::make(mesh.points.rows(), mesh.triangles);
      if (!topology) return fail(name, topology.error().what);
      first = name;
      shapes.push_back({*topology, mesh.points});
      return {};
    }
    const auto& topology = shapes.front().topology;
    const bool same_faces =
        topology->triangles().rows() == mesh.triangles.rows() &&
        (topology->triangles() == mesh.triangles || turned_faces(topology->triangles(), mesh.triangles));
    if (mesh.points.rows() != topology->vertices() || !same_faces) {
      return fail(name, "has another numbering or other faces than " + first +
                            "; only shapes in correspondence can be shown together");
    }
    shapes.push_back({topology, mesh.points});
    return {};
  };
  auto warnings = read_shapes(*sources, {verb.all_frames}, take, &progress);
  if (!warnings) return fail(warnings.error());
  auto report = write(correspondence_picture(shapes, names, montage_options(verb)), verb);
  if (report) report->warnings = std::move(*warnings);
  return report;
}

/// The structures of each case as one shape, or one of them.
Result<Report> joint_correspondence(const PictureVerb& verb, Progress& progress) {
  const auto cases = structure_files(verb.in, verb.structures);
  if (!cases) return fail(cases.error());
  const auto joint = read_joint_set(*cases, verb.structures, {}, &progress);
  if (!joint) return fail(joint.error());
  const TrainingSet& set = joint->read.set;
  if (!set.topology) return fail(verb.in.front().string(), "holds points only; a picture needs faces, so give meshes");
  std::shared_ptr<const Topology> topology = set.topology;
  ShapeMatrix points = set.shapes;
  if (!verb.structure.empty()) {
    const StructurePart* part = part_named(joint->parts, verb.structure);
    if (part == nullptr)
      return fail("--structure " + verb.structure,
                  "is none of the structures that are joined; name " + listed(verb.structures, " or "));
    auto own = Topology::make(part->vertices, triangles_of(*part, topology->triangles()));
    if (!own) return fail(part->name, own.error().what);
    topology = std::move(*own);
    points = rows_of(*part, set.shapes);
  }
  std::vector<Mesh> shapes;
  for (Eigen::Index s = 0; s < points.cols(); ++s) shapes.push_back({topology, points_of(points, s)});
  auto report = write(correspondence_picture(shapes, set.names, montage_options(verb)), verb);
  if (report) report->warnings = joint->read.warnings;
  return report;
}

Result<Report> of_model(const PictureVerb& verb) {
  const auto model = read_model_part(verb.in.front(), verb.structure);
  if (!model) return fail(model.error());
  return write(modes_picture(*model, verb.modes, montage_options(verb)), verb);
}

Result<Report> of_case(const PictureVerb& verb, Progress& progress) {
  const MontageOptions options = montage_options(verb);
  ReplayOptions replay;
  replay.progress = &progress;
  const auto read = read_case(verb.in.front(), replay);
  if (!read) return fail(read.error());
  auto report = write(case_picture(read->session.document(), options), verb);
  if (report) report->warnings = read->warnings;
  return report;
}

/// Writes the window as it shows a session.
Result<Report> write_window(EditSession session, EditorPictureOptions window, const PictureVerb& verb,
                            std::vector<std::string> warnings) {
  const auto context = OffscreenContext::make();
  if (!context) return fail(context.error());
  const MontageOptions options = montage_options(verb);
  window.width_px = options.width_px;
  window.height_px = options.height_px;
  window.part = part_of(verb);
  if (window.part) {
    // As the window of the usual size shows it: the picture is as large as it was asked for.
    const EditorPictureOptions usual;
    window.width_px = usual.width_px;
    window.height_px = usual.height_px;
  }
  const auto picture = editor_picture(std::move(session), window);
  if (!picture) return fail(picture.error());
  if (auto written = write_picture(*picture, verb.out); !written) return fail(written.error());
  return Report{{{"size", Json::array({picture->width, picture->height})}}, std::move(warnings)};
}

Result<Report> of_window(const PictureVerb& verb, Progress& progress) {
  ReplayOptions replay;
  replay.progress = &progress;
  auto read = read_case(verb.in.front(), replay);
  if (!read) return fail(read.error());
  return write_window(std::move(read->session), {}, verb, std::move(read->warnings));
}

Result<Report> of_study(const PictureVerb& verb) {
  auto read = read_study(verb.in.front());
  if (!read) return fail(read.error());
  EditorPictureOptions window;
  window.arrange = [&](EditorState& state) { show_study(state.models, std::move(read->study), verb.in.front()); };
  if (verb.only.empty()) window.models = StartEvaluation{};
  auto warnings = read->warnings;
  return write_window(EditSession(new_document({}, nullptr, nullptr)), window, verb, std::move(warnings));
}

/// --ground and --captions; gives the first.
CLI::Option* add_ground(CLI::App& verb, PictureVerb& options) {
  verb.add_flag("--captions", options.captions, "Write names and a scale bar on the picture");
  return verb.add_option("--ground", options.ground, "Behind what is shown: dark, light or transparent")
      ->check(CLI::IsMember(grounds));
}

void add_options(CLI::App& verb, PictureVerb& options) {
  verb.add_option("-o,--output", options.out, "The picture to write (.png)")->required();
  add_size(verb, options.size);
  verb.add_option("--view", options.view,
                  "Where the 3D view looks from: anterior, posterior, left, right, superior, inferior or x,y,z")
      ->check([](const std::string& text) {
        const auto direction = direction_from_name(text);
        return direction ? std::string() : direction.error().sentence();
      });
  verb.add_option("--glyph-spacing", options.glyph_spacing_mm, "Least distance between glyphs in mm")
      ->check(CLI::PositiveNumber);
  auto* transparent = verb.add_flag("--transparent", options.transparent, "The same as --ground transparent");
  add_ground(verb, options)->excludes(transparent);
}

/// --only, with what can be said of a part of the window.
void add_part(CLI::App& verb, PictureVerb& options, const std::vector<std::string>& names, const char* help) {
  auto* only = verb.add_option("--only", options.only, help)->check(CLI::IsMember(names));
  add_ground(verb, options)->needs(only);
  verb.get_option("--captions")->needs(only);
}

}  // namespace

void add_picture(CLI::App& app, CommandLine& asked) {
  CLI::App* picture = app.add_subcommand("picture", "Pictures without a display");
  picture->require_subcommand(1);
  auto options = std::make_shared<PictureVerb>();
  CLI::App* all = add_verb(*picture, "correspondence", "Shapes in a grid; equal hues and glyphs are equal vertices");
  all->add_option("SHAPE", options->in,
                  "Shapes in correspondence: meshes, case files (.homolog), a study (.study.json)")
      ->required();
  all->add_flag("--all-frames", options->all_frames, "Show every edited frame of a cine");
  auto* structures =
      all->add_option("--structures", options->structures,
                      "Join several structures, as A,B, of a folder with CASE/A.ply as fit SET writes it")
          ->delimiter(',')
          ->excludes("--all-frames");
  all->add_option("--structure", options->structure, "Of those this one alone")->needs(structures);
  add_options(*all, *options);
  all->callback([options, &asked] {
    asked.run = [options](Progress& progress) {
      return options->structures.empty() ? correspondence(*options, progress)
                                         : joint_correspondence(*options, progress);
    };
  });
  CLI::App* modes = add_verb(*picture, "modes", "Modes of a model: -3, 0 and +3 standard deviations");
  modes->add_option("MODEL", options->in, "The model (.h5.json or .h5)")->required()->expected(1);
  modes->add_option("--structure", options->structure, "Of a joint model this structure alone");
  modes->add_option("--modes", options->modes, "How many modes to show, a row for each")->check(CLI::Range(1, 20));
  add_options(*modes, *options);
  modes->callback([options, &asked] { asked.run = [options](Progress&) { return of_model(*options); }; });
  CLI::App* one = add_verb(*picture, "case", "A case: three slices with the outline, and the shape in 3D");
  one->add_option("CASE", options->in, "The case file")->required()->expected(1);
  add_options(*one, *options);
  CLI::App* window = add_verb(*picture, "window", "A case as the editor's window shows it");
  window->add_option("CASE", options->in, "The case file")->required()->expected(1);
  window->add_option("-o,--output", options->out, "The picture to write (.png)")->required();
  add_size(*window, options->size);
  add_part(*window, *options, view_names, "One view in place of the window: axial, sagittal, coronal or 3d");
  window->callback(
      [options, &asked] { asked.run = [options](Progress& progress) { return of_window(*options, progress); }; });
  CLI::App* study = add_verb(*picture, "study", "A study's models, as the editor's window shows them");
  study->add_option("STUDY", options->in, "The study (.study.json)")->required()->expected(1);
  study->add_option("-o,--output", options->out, "The picture to write (.png)")->required();
  add_size(*study, options->size);
  add_part(*study, *options, study_names,
           "In place of the window: gallery (all shapes) or modes (-3, 0 and +3 standard deviations)");
  study->callback([options, &asked] { asked.run = [options](Progress&) { return of_study(*options); }; });
  one->callback(
      [options, &asked] { asked.run = [options](Progress& progress) { return of_case(*options, progress); }; });
}

}  // namespace homolog
