#include <algorithm>
#include <charconv>
#include <filesystem>
#include <optional>
#include <tuple>
#include <utility>
#include <vector>

#include "app/editor/window/editor_picture.h"
#include "app/verbs/model/model_part.h"
#include "app/verbs/model/training.h"
#include "app/verbs/picture/picture_verb.h"
#include "core/base/files/file_stem.h"
#include "core/base/pictures/picture_io.h"
#include "core/mesh/construction/mirror.h"
#include "core/model/joint_models/joint_set.h"
#include "core/model/joint_models/structure_files.h"
#include "core/model/shapes/shape_files.h"
#include "core/model/shapes/study.h"
#include "core/model/training_set.h"
#include "core/session/case_file.h"
#include "render/offscreen.h"

namespace homolog {

namespace fs = std::filesystem;

constexpr int largest_side_px = 16384;

std::optional<std::pair<int, int>> parsed_size(const std::string& text) {
  const char *begin = text.data(), *end = begin + text.size();
  int width = 0, height = 0;
  const auto first = std::from_chars(begin, end, width);
  if (first.ec != std::errc() || first.ptr == end || *first.ptr != 'x') return std::nullopt;
  if (std::from_chars(first.ptr + 1, end, height).ptr != end) return std::nullopt;
  if (std::min(width, height) < 64 || std::max(width, height) > largest_side_px) return std::nullopt;
  return std::pair(width, height);
}

namespace {

const std::vector<std::string> view_names{"axial", "sagittal", "coronal", "3d"};  // as all_views
const std::vector<std::string> study_names{"gallery", "modes"};

void add_size(CLI::App& verb, std::string& size) {
  verb.add_option("--size", size, "WIDTHxHEIGHT in pixels")->check([](const std::string& text) {
    return parsed_size(text) ? std::string() : text + " is not WIDTHxHEIGHT in pixels between 64 and 16384";
  });
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
    part.view = all_views[view - view_names.begin()];
  else
    part.study = verb.only == "modes" ? StudyPicture::modes : StudyPicture::gallery;
  return part;
}

Result<Report> write(Result<MadePicture> made, const PictureVerb& verb) {
  if (!made) return fail(about(verb, made.error()));
  const MontageOptions options = montage_options(verb);
  const int glyphs = made->glyphs;
  if (options.captions) {
    auto report = write_plate(captioned(std::move(*made), options), verb);
    if (report) report->values["glyphs"] = glyphs;
    return report;
  }
  if (auto written = write_picture(made->picture, verb.out); !written) return fail(written.error());
  return Report{
      {{"glyphs", glyphs}, {"size", Json::array({made->picture.width, made->picture.height})}}, {}, {verb.out}};
}

/// Mirror images of most others are named, and flipped where that is asked. One that stays has its faces turned, so
/// that they look outward.
std::vector<std::string> settle_mirrored(const PictureVerb& verb, const std::vector<std::string>& names,
                                         std::vector<Mesh>& shapes) {
  TrainingSet all{names, shapes.front().topology, ShapeMatrix(shapes.front().points.size(), std::ssize(shapes))};
  for (std::size_t k = 0; k < shapes.size(); ++k)
    all.shapes.col(static_cast<Eigen::Index>(k)) =
        Eigen::Map<const Eigen::VectorXd>(shapes[k].points.data(), shapes[k].points.size());
  std::vector<std::string> found;
  for (const Eigen::Index k : mirrored_shapes(all)) {
    Mesh& shape = shapes[k];
    found.push_back(names[k] + ": a mirror image of the other shapes (left and right exchanged); " +
                    (verb.flip_mirrored ? "flipped" : "use --flip-mirrored to flip it"));
    if (verb.flip_mirrored) {
      shape.points.col(0) *= -1;
      continue;
    }
    Triangles faces = shape.topology->triangles();
    faces.col(1).swap(faces.col(2));
    if (auto own = Topology::make(shape.topology->vertices(), std::move(faces))) shape.topology = *own;
  }
  return found;
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
  const auto mirrored = settle_mirrored(verb, names, shapes);
  warnings->insert(warnings->end(), mirrored.begin(), mirrored.end());
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

/// A mode as it plays: a GIF, or a picture of each frame.
Result<Report> of_playing_mode(const PictureVerb& verb, Progress& progress) {
  const auto model = read_model_part(verb.in.front(), verb.structure);
  if (!model) return fail(model.error());
  if (!model->topology)
    return fail(verb.in.front().string(), "is a model of points without faces, which cannot be drawn");
  if (verb.mode > model->modes())
    return fail("--mode " + std::to_string(verb.mode), "is more than the " + std::to_string(model->modes()) +
                                                           " modes that " + verb.in.front().string() + " has");
  const MontageOptions options = montage_options(verb);
  progress.part(0, 0.9);
  const auto frames = montage_frames(playing_mode(*model, verb.mode - 1, verb.frames, options.from), options, progress);
  if (!frames) return fail(about(verb, frames.error()));
  Report report{{{"mode", verb.mode},
                 {"frames", frames->size()},
                 {"size", Json::array({frames->front().width, frames->front().height})}},
                {}};
  if (is_gif_name(verb.out)) {
    report.made = {verb.out};
    constexpr int hundredths_of_a_turn = 200;
    if (auto written = write_gif(*frames, std::max(2, hundredths_of_a_turn / verb.frames), verb.out); !written)
      return fail(written.error());
  } else {
    for (std::size_t k = 0; k < frames->size(); ++k) {
      if (progress.cancelled()) return fail("", "cancelled");
      const std::string number = std::to_string(10001 + k).substr(1);
      const fs::path file =
          verb.out.parent_path() / (file_stem(verb.out) + '-' + number + verb.out.extension().string());
      if (auto written = write_picture((*frames)[k], file); !written) return fail(written.error());
      report.made.push_back(file);
    }
  }
  return report;
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
  return Report{{{"size", Json::array({picture->width, picture->height})}}, std::move(warnings), {verb.out}};
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

/// For print: the shapes or the modes by themselves, since a window has no place on paper.
Result<Report> of_study_for_print(const PictureVerb& verb, Progress& progress) {
  constexpr int modes = 3;
  if (verb.only != "modes") return correspondence(verb, progress);
  TrainingVerb set;
  set.files = verb.in;
  const auto training = train(set, progress);
  if (!training) return fail(training.error());
  auto report = write(
      modes_picture(make_model(training->components, 1, training->topology, {}), modes, montage_options(verb)), verb);
  if (report) report->warnings = training->warnings;
  return report;
}

/// --ground and --captions; gives the first.
CLI::Option* add_ground(CLI::App& verb, PictureVerb& options) {
  verb.add_flag("--captions", options.captions, "Write names and a scale bar on the picture");
  return verb.add_option("--ground", options.ground, "Behind what is shown: dark, light or transparent")
      ->check(CLI::IsMember({"dark", "light", "transparent"}));
}

void add_options(CLI::App& verb, PictureVerb& options) {
  verb.add_option("-o,--output", options.out, "The picture to write: .png, or for print .svg or .pdf")->required();
  add_size(verb, options.size);
  add_width(verb, options)->excludes("--size");
  add_view(verb, options);
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
  add_plates(*picture, options, asked);
  CLI::App* all = add_verb(*picture, "correspondence", "Shapes in a grid; equal hues and glyphs are equal vertices");
  all->add_option("SHAPE", options->in,
                  "Shapes in correspondence: meshes, case files (.homolog), a study (.study.json)")
      ->required();
  all->add_flag("--all-frames", options->all_frames, "Show every edited frame of a cine");
  all->add_flag("--flip-mirrored", options->flip_mirrored, "Flip shapes that are mirror images of most others");
  auto* structures =
      all->add_option("--structures", options->structures,
                      "Join several structures, as A,B, of a folder with CASE/A.ply as fit SET writes it")
          ->delimiter(',')
          ->excludes("--all-frames")
          ->excludes("--flip-mirrored");
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
  auto* mode = modes->add_option("--mode", options->mode, "Let this mode play, as .gif or as numbered .png")
                   ->check(CLI::Range(1, 1000))
                   ->excludes("--modes");
  modes->add_option("--frames", options->frames, "How many pictures of it, from the mean to +3, -3 and back")
      ->check(CLI::Range(2, 1000))
      ->needs(mode);
  modes->callback([options, modes, &asked] {
    const bool plays = options->mode > 0;
    if (is_gif_name(options->out) != plays && (!plays || is_page_name(options->out)))
      throw CLI::ValidationError("-o " + options->out.string(), plays ? "cannot play; use .gif, or .png for the frames"
                                                                      : "plays one mode; name it with --mode");
    if (plays) refuse_without_effect(*modes, "--width-mm", "pages, which do not play");
    if (plays && modes->count("--size") == 0) options->size = "640x480";
    if (plays && options->ground.empty() && !options->transparent) options->ground = "light";
    asked.run = [options, plays](Progress& progress) {
      return plays ? of_playing_mode(*options, progress) : of_model(*options);
    };
  });
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
  study->add_option("-o,--output", options->out, "The picture to write: .png, or for print .svg or .pdf")->required();
  add_size(*study, options->size);
  add_width(*study, *options)->excludes("--size");
  add_view(*study, *options);
  add_part(*study, *options, study_names,
           "In place of the window: gallery (all shapes; of a page the default) or modes (-3, 0 and +3 standard "
           "deviations)");
  study->callback([options, study, &asked] {
    const bool prints = options->is_for_print();
    if (!prints) refuse_without_effect(*study, "--view", "pages; in the window you turn the shapes");
    asked.run = [options, prints](Progress& progress) {
      return prints ? of_study_for_print(*options, progress) : of_study(*options);
    };
  });
  one->callback(
      [options, &asked] { asked.run = [options](Progress& progress) { return of_case(*options, progress); }; });
  // A name that no picture can have is refused before anything is drawn.
  picture->final_callback([picture, options, &asked] {
    for (const CLI::App* kind : picture->get_subcommands())
      if (is_page_name(options->out) && kind->get_option_no_throw("--size") != nullptr)
        refuse_without_effect(*kind, "--size", "pictures in pixels; --width-mm is how wide a page is");
    asked.run = [options, draw = std::move(asked.run)](Progress& progress) -> Result<Report> {
      const fs::path& out = options->out;
      if (!is_page_name(out) && !is_gif_name(out))
        if (auto can = can_write_picture(out); !can) return fail(can.error());
      return draw(progress);
    };
  });
}

}  // namespace homolog
