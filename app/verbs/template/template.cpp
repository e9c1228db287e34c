#include <algorithm>
#include <filesystem>
#include <limits>
#include <memory>
#include <optional>
#include <utility>

#include "app/verbs/case_landmarks.h"
#include "app/verbs/describe.h"
#include "app/verbs/mending_report.h"
#include "app/verbs/read_image.h"
#include "app/verbs/record.h"
#include "app/verbs/template/subjects.h"
#include "app/verbs/template/template_job.h"
#include "app/verbs/verb.h"
#include "core/base/text/lengths.h"
#include "core/mesh/files/landmark_io.h"
#include "core/mesh/geometry/surface_search.h"
#include "core/mesh/mesh_io.h"
#include "core/template/template.h"

// The verb `template`: makes a template from a label map or from an existing surface.

namespace homolog {

namespace fs = std::filesystem;

namespace {

constexpr double far_share = 0.05;  ///< of the diagonal: a landmark farther from the surface is said
constexpr double away_share = 0.5;  ///< so far from the nearest of them, the landmarks are of another place

/// Gives a template the landmarks of a file; one of a name that it has already takes the other's place. Errors: no
/// points; all of them far away.
Result<void> add_landmarks_of(const fs::path& path, MeshFile& file, std::vector<std::string>& warnings) {
  const auto landmarks = read_landmarks(path);
  if (!landmarks) return fail(landmarks.error());
  if (landmarks->empty()) return fail(path.string(), "holds no points; place the landmarks and save it again");
  const auto topology = Topology::make(file.points.rows(), file.triangles);
  if (!topology) return fail(topology.error());
  const SurfaceSearch search({*topology, file.points});
  const double diagonal_mm = bounds_of(file.points).diagonal().norm();
  double nearest_mm = std::numeric_limits<double>::infinity();
  for (const Landmark& landmark : *landmarks) {
    const double mm = search.nearest(landmark.position).distance_mm;
    nearest_mm = std::min(nearest_mm, mm);
    if (mm > far_share * diagonal_mm)
      warnings.push_back(path.string() + ": \"" + landmark.name + "\" lies " + in_mm(mm, 0) +
                         " from the template's surface; check its place");
    std::erase_if(file.landmarks, [&](const Landmark& other) { return other.name == landmark.name; });
    file.landmarks.push_back(landmark);
  }
  if (nearest_mm <= away_share * diagonal_mm) return {};
  return fail(path.string(), "has its points " + in_mm(nearest_mm, 0) +
                                 " and more from the surface; check that both are of one scan and in one space (LPS or "
                                 "RAS)");
}

/// A folder of subjects stands for its surfaces or its label maps.
GivenCommand with_subjects_opened(const TemplateJob& options) {
  GivenCommand command = options.command;
  if (!options.consensus.empty()) command = command.with("--consensus", subject_paths(options.consensus));
  if (!options.best_of.empty()) command = command.with("--best-of", subject_paths(options.best_of));
  return command;
}

/// Makes the template, gives it its landmarks and writes it.
Result<Report> make_template_file(const TemplateJob& options, Progress& progress) {
  if (auto there = check_folder_of(options.out); !there) return fail(there.error());
  const bool of_many = !options.consensus.empty() || !options.best_of.empty();
  auto made = of_many ? make_template_of_many(options, progress) : make_template_of_one(options, true, progress);
  if (!made) return fail(made.error());
  const fs::path& out = options.out;
  MeshFile& file = made->file;
  if (!options.landmarks.empty())
    if (auto added = add_landmarks_of(options.landmarks, file, made->warnings); !added) return fail(added.error());
  auto report = describe(file, out);
  if (!report) return report;
  for (std::string& fault : faults_of(file, out)) made->warnings.push_back(std::move(fault));
  report->values.update(made->values);
  report->warnings = std::move(made->of_reading);
  report->warnings.insert(report->warnings.end(), made->warnings.begin(), made->warnings.end());
  auto record = record_of(with_subjects_opened(options), progress);
  if (!record) return fail(record.error());
  file.record = std::move(*record);
  if (auto written = write_mesh_file(file, out); !written) return fail(written.error());
  return report;
}

/// `options` lives as long as the verb.
void add_tube_options(CLI::App& verb, TemplateJob& options) {
  auto* tube_flag = verb.add_flag("--tube", options.tube, "A ring × sector grid along an axis (left ventricle)");
  verb.add_option("--rings", options.rings, "Rings of a tube, base to apex")
      ->check(CLI::Range(3, 1000))
      ->needs(tube_flag)
      ->capture_default_str();
  verb.add_option("--sectors", options.sectors, "Vertices of a ring")
      ->check(CLI::Range(6, 1000))
      ->needs(tube_flag)
      ->capture_default_str();
  verb.add_option(
          "--axis", options.axis,
          "X,Y,Z direction from the base to the apex (LPS); else the slices' normal where slices are thick, or the "
          "label's main axis")
      ->delimiter(',')
      ->expected(3)
      ->needs(tube_flag);
  auto* base = verb.add_option("--base", options.base, "X,Y,Z point on the axis where the rings begin (LPS mm)")
                   ->delimiter(',')
                   ->expected(3)
                   ->needs(tube_flag);
  auto* apex = verb.add_option("--apex", options.apex, "X,Y,Z point towards which the axis runs from --base")
                   ->delimiter(',')
                   ->expected(3)
                   ->needs(base);
  base->needs(apex);
  verb.add_flag("--capped", options.capped, "Close the tube's base with a flat fan")->needs(tube_flag);
  verb.add_option("--outer-label", options.outer_label,
                  "Label of the wall around it: adds a second sheet (epicardium) to the mesh")
      ->check(CLI::PositiveNumber)
      ->needs(tube_flag);
}

/// Refuses options that were given and do nothing for such a template.
void check_template_effect(const TemplateJob& options, const CLI::App& verb) {
  if (options.keep_vertices) {
    if (options.in.empty() || !keeps_numbers(options.in))
      throw CLI::ValidationError("--keep-vertices", "has no effect here: it is for a mesh whose format keeps vertices");
    for (const char* name : {"--vertices", "--closing-mm", "--opening-mm", "--genus", "--holes"})
      refuse_without_effect(verb, name, "templates whose vertices are spread anew");
  }
  const bool of_many = !options.consensus.empty() || !options.best_of.empty();
  if (of_many && options.tube)
    throw CLI::ValidationError(options.best_of.empty() ? "--consensus" : "--best-of",
                               "is not for --tube, whose rings are alike in all subjects");
  if (of_many || options.tube || is_mesh_name(options.in))
    refuse_without_effect(verb, "--parts", "a template of one label map without --tube");
  if (of_many || options.tube || !is_mesh_name(options.in))
    refuse_without_effect(verb, "--holes", "a template of one surface");
  if (!options.consensus.empty()) refuse_without_effect(verb, "--opening-mm", "a template of one subject");
  if (!of_many) refuse_without_effect(verb, "--flip-mirrored", "--consensus and --best-of");
  if (options.faced) {
    if (!options.best_of.empty() || options.tube)
      throw CLI::ValidationError(options.faced->kept ? "--facing" : "--open-at",
                                 "is for a template of one label map, or for a --consensus of several");
    for (const char* name : {"--opening-mm", "--genus", "--parts"})
      refuse_without_effect(verb, name, "templates of a whole surface");
  }
  if (options.tube)
    for (const char* name : {"--vertices", "--closing-mm", "--opening-mm", "--genus", "--level"})
      refuse_without_effect(verb, name, "templates without --tube");
}

}  // namespace

void add_template(CLI::App& app, CommandLine& asked) {
  auto options = std::make_shared<TemplateJob>();
  CLI::App* verb = add_verb(app, "template", "A template from a label map or from a surface");
  auto* in = verb->add_option("MASK", options->in, "A label map, or a surface (STL, PLY, …) to spread vertices over");
  constexpr int most_subjects = 1000000;
  auto* consensus =
      verb->add_option(
              "--consensus", options->consensus,
              "Surfaces or label maps of several subjects, or a folder of them: their mean shape, which depends "
              "far less on any one of them")
          ->excludes(in)
          ->expected(1, most_subjects);
  verb->add_option("--best-of", options->best_of,
                   "The same, but of one of them: that whose template fits the others best")
      ->excludes(in)
      ->excludes(consensus)
      ->expected(1, most_subjects);
  verb->add_flag("--flip-mirrored", options->flip_mirrored, "Flip subjects that are mirror images of most others");
  keeps_correspondence(verb->add_option("-o,--output", options->out,
                                        "The template to write (.ply keeps stiffness, regions and landmarks)")
                           ->required());
  verb->add_option("--landmarks", options->landmarks,
                   "Named points for the template (.mrk.json, .fcsv, .json), in the template's space");
  add_label_option(*verb, options->label,
                   "Which label of the mask, where it holds several, by number or name; 1,2: both together");
  add_mask_frame_option(*verb, options->frame);
  add_level_option(*verb, options->level);
  verb->add_option("--vertices", options->vertices, "How many vertices")
      ->check(CLI::Range(100, 200000))
      ->capture_default_str();
  verb->add_flag("--keep-vertices", options->keep_vertices,
                 "Of a mesh: its vertices and faces stay as they are, numbered as before, and get --landmarks");
  const auto add_faced = [&](const char* name, bool kept, const char* help) {
    return verb->add_option_function<std::string>(
        name,
        [options, kept](const std::string& labels) {
          options->faced = FacedNames{labels, kept};
        },
        help);
  };
  add_faced("--facing", true,
            "Of the label's surface only what faces these labels (numbers, names, background), open at its rim")
      ->excludes(add_faced("--open-at", false,
                           "The label's surface without what faces these labels, as a ventricle's without its valves"));
  add_ball_option(*verb, "--closing-mm", options->closing_mm,
                  "Clefts narrower than twice this radius (mm) are filled; of a surface only where given");
  add_ball_option(*verb, "--opening-mm", options->opening_mm,
                  "Spurs thinner than twice this radius (mm) are removed; of a surface only where given");
  add_genus_option(*verb, options->genus,
                   "Tunnels. auto: cut those narrower than 0.035 of the organ's size (of a surface, where it has more "
                   "than 16); keep: cut none; a number: cut the narrowest until so many are left");
  add_holes_option(*verb, options->holes);
  verb->add_option("--parts", options->parts,
                   "Of a label in several parts: largest; all: a mesh of as many pieces, the largest first")
      ->check(CLI::IsMember({"largest", "all"}))
      ->capture_default_str();
  add_tube_options(*verb, *options);
  verb->callback([options, verb, &asked] {
    if (options->in.empty() && options->consensus.empty() && options->best_of.empty())
      throw CLI::RequiredError("MASK, or --consensus or --best-of with several subjects");
    check_template_effect(*options, *verb);
    if (!options->axis.empty() && Vec3(options->axis.data()).norm() < 1e-9)
      throw CLI::ValidationError("--axis", "needs a direction other than 0,0,0");
    if (options->base == options->apex && !options->base.empty())
      throw CLI::ValidationError("--apex", "needs a point other than --base");
    options->command = given_command(*verb);
    asked.run = [options](Progress& progress) { return make_template_file(*options, progress); };
  });
}

}  // namespace homolog
