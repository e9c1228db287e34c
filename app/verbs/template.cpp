#include <algorithm>
#include <filesystem>
#include <memory>

#include "app/verbs/describe.h"
#include "app/verbs/read_image.h"
#include "app/verbs/subjects.h"
#include "app/verbs/verb.h"
#include "core/mesh/mesh_faults.h"
#include "core/mesh/mesh_io.h"
#include "core/template_making/mesh_template.h"
#include "core/template_making/template_file.h"
#include "core/volume/volume_io.h"

// The verb `template`: makes a template from a label map or from an existing surface.

namespace homolog {

namespace fs = std::filesystem;

namespace {

struct TemplateJob {
  fs::path in, out;
  std::vector<fs::path> consensus;
  bool flip_mirrored = false;
  int label = 0, frame = 0, vertices = 2500;
  double closing_mm = MaskTemplateOptions{}.closing_mm, opening_mm = MaskTemplateOptions{}.opening_mm;
  std::string genus = "auto";
  bool tube = false, capped = false;
  int rings = TubeTemplateOptions{}.rings, sectors = TubeTemplateOptions{}.sectors, outer_label = 0;
  std::vector<double> axis, base, apex;
};

std::string how_cut(const CutTunnel& tunnel) {
  return tunnel.how == CutTunnel::How::filled ? "filled" : "severed";
}

/// What is wrong with a template that was made, each a sentence.
std::vector<std::string> faults_of(const MeshFile& file, const fs::path& out) {
  const auto topology = Topology::make(file.points.rows(), file.triangles);
  if (!topology) return {};
  const MeshFaults faults = mesh_faults({*topology, file.points});
  std::vector<std::string> sentences;
  if (faults.any())
    sentences.push_back(out.string() + ": has " + faults.words() +
                        ", so fits with it will have faults too; repair the surface, or ask for more vertices");
  if (faults.riddled())
    sentences.push_back(out.string() + ": has " + std::to_string(faults.tunnels) +
                        " tunnels, more than organs have; use --closing-mm or --genus to close tunnels of a label map");
  return sentences;
}

Result<Report> finish(const MeshFile& file, const fs::path& out, Json further, std::vector<std::string> warnings) {
  auto report = describe(file, out);
  if (!report) return report;
  for (std::string& fault : faults_of(file, out)) warnings.push_back(std::move(fault));
  report->values.update(further);
  report->warnings = std::move(warnings);
  if (auto written = write_mesh_file(file, out); !written) return fail(written.error());
  return report;
}

GenusRule genus_rule(const std::string& text) {
  GenusRule rule;
  if (text == "auto") return rule;
  rule.kind = text == "keep" ? GenusRule::Kind::keep : GenusRule::Kind::number;
  if (rule.kind == GenusRule::Kind::number) rule.genus = std::stoi(text);  // checked when parsed
  return rule;
}

Result<Report> from_mask(const TemplateJob& options, const Volume& mask, int label, std::vector<std::string> warnings,
                         Progress& progress) {
  MaskTemplateOptions making;
  making.label = label;
  making.frame = options.frame;
  making.vertices = options.vertices;
  making.closing_mm = options.closing_mm;
  making.opening_mm = options.opening_mm;
  making.genus = genus_rule(options.genus);
  const auto made = make_mask_template(mask, making, &progress);
  if (!made) return fail(options.in.string(), made.error().what);
  for (std::string& warning : about(options.in, made->warnings)) warnings.push_back(std::move(warning));

  Json tunnels = Json::array();
  for (const CutTunnel& tunnel : made->tunnels)
    tunnels.push_back({{"at_mm", json_of(tunnel.at_mm)}, {"below_mm", tunnel.width_mm}, {"how", how_cut(tunnel)}});
  const Json removed{{"islands_ml", made->islands_ml},
                     {"cavities", made->cavities},
                     {"cavities_ml", made->cavities_ml},
                     {"tunnels", tunnels}};
  const Json provenance = provenance_of(options.in.filename().string(), making);
  return finish(template_file(made->mesh, provenance), options.out,
                {{"distance_to_mask_mm", json_of(made->to_mask)},
                 {"distance_from_mask_mm", json_of(made->from_mask)},
                 {"resampled_mm", made->resampled_mm},
                 {"missed", {{"ml", made->missed_ml}, {"share", made->missed_share}}},
                 {"removed", removed}},
                std::move(warnings));
}

Result<Report> tube(const TemplateJob& options, const Volume& mask, int label, std::vector<std::string> warnings) {
  TubeTemplateOptions making;
  making.label = label;
  making.frame = options.frame;
  making.rings = options.rings;
  making.sectors = options.sectors;
  making.capped = options.capped;
  if (options.outer_label != 0) making.outer_label = options.outer_label;
  if (!options.axis.empty()) making.axis = Vec3(options.axis.data());
  if (!options.base.empty()) making.base_and_apex = {Vec3(options.base.data()), Vec3(options.apex.data())};
  const auto made = make_tube_template(mask, making);
  if (!made) return fail(options.in.string(), made.error().what);
  for (std::string& warning : about(options.in, made->warnings)) warnings.push_back(std::move(warning));
  const Json provenance = provenance_of(options.in.filename().string(), making);
  return finish(template_file(made->mesh, provenance), options.out,
                {{"distance_to_mask_mm", json_of(made->to_mask)},
                 {"distance_from_mask_mm", json_of(made->from_mask)},
                 {"axis", json_of(made->axis)}},
                std::move(warnings));
}

Result<Report> from_mesh(const TemplateJob& options, Progress& progress) {
  const auto surface = read_mesh_file(options.in);
  if (!surface) return fail(surface.error());
  auto made = make_mesh_template(*surface, options.vertices, &progress);
  if (!made) return fail(options.in.string(), made.error().what);
  MeshFile file =
      template_file(made->mesh, {{"source", options.in.filename().string()}, {"vertices", options.vertices}});
  file.landmarks = surface->landmarks;
  return finish(file, options.out,
                {{"distance_to_mesh_mm", json_of(made->to_mesh)}, {"distance_from_mesh_mm", json_of(made->from_mesh)}},
                about(options.in, std::move(made->warnings)));
}

Result<Report> from_consensus(const TemplateJob& options, Progress& progress) {
  progress.part(0, 0.05);
  auto read = read_subjects(
      {options.consensus, {}, options.label, options.closing_mm, options.vertices, options.flip_mirrored}, progress);
  if (!read) return fail(read.error());
  progress.part(0, 1);
  Progress making(progress, 0.95);
  std::vector<Boundary> subjects;
  for (BiasSubject& subject : read->subjects) subjects.push_back(std::move(subject.boundary));
  const auto made = consensus_template(subjects, {.vertices = options.vertices, .progress = &making});
  if (!made) return fail(options.consensus.front().string(), made.error().what);
  std::vector<std::string> warnings = std::move(read->warnings);
  Json names = Json::array();
  for (const BiasSubject& subject : read->subjects) names.push_back(subject.name);
  for (const std::size_t k : made->left_out)
    warnings.push_back(read->subjects[k].name + ": could not be fitted, so the template is made without it");
  if (!made->rests)
    warnings.push_back("the mean still moved in the last round; the subjects differ much, so look at the template");
  return finish(template_file(made->mesh, {{"consensus", names}, {"vertices", options.vertices}}), options.out,
                {{"subjects", subjects.size()},
                 {"rounds", made->rounds},
                 {"moved_mm", made->moved_mm},
                 {"rests", made->rests},
                 {"flipped", read->flipped}},
                std::move(warnings));
}

Result<Report> make_template_file(const TemplateJob& options, Progress& progress) {
  if (!options.consensus.empty()) return from_consensus(options, progress);
  if (is_mesh_name(options.in)) {
    if (options.tube)
      return fail(options.in.string(), "is a mesh, and --tube needs a label map; make one with label-map first");
    return from_mesh(options, progress);
  }
  const auto mask = read_mask(options.in, options.label, options.frame, progress);
  if (!mask) return fail(mask.error());
  return options.tube ? tube(options, mask->volume, mask->label, mask->warnings)
                      : from_mask(options, mask->volume, mask->label, mask->warnings, progress);
}

}  // namespace

void add_template(CLI::App& app, CommandLine& asked) {
  auto options = std::make_shared<TemplateJob>();
  CLI::App* verb = add_verb(app, "template", "A template from a label map or from a surface");
  auto* in = verb->add_option("MASK", options->in, "A label map, or a surface (STL, PLY, …) to spread vertices over");
  auto* consensus = verb->add_option("--consensus", options->consensus,
                                     "Surfaces or label maps of several subjects: their mean shape, which does not "
                                     "depend on any of them alone")
                        ->excludes(in)
                        ->expected(2, 1000000);
  verb->add_flag("--flip-mirrored", options->flip_mirrored, "Flip subjects that are mirror images of most others")
      ->needs(consensus);
  verb->add_option("-o,--output", options->out, "The template to write (.ply keeps stiffness, regions and landmarks)")
      ->required();
  verb->add_option("--label", options->label, "Which label of the mask, where it holds several")
      ->check(CLI::PositiveNumber);
  verb->add_option("--frame", options->frame, "Which frame of a cine label map, from 0")->check(CLI::NonNegativeNumber);
  verb->add_option("--vertices", options->vertices, "How many vertices")
      ->check(CLI::Range(100, 200000))
      ->capture_default_str();
  verb->add_option("--closing-mm", options->closing_mm, "Clefts narrower than twice this radius (mm) are filled")
      ->check(CLI::Range(0.0, 20.0))
      ->capture_default_str();
  verb->add_option("--opening-mm", options->opening_mm, "Spurs thinner than twice this radius (mm) are removed")
      ->check(CLI::Range(0.0, 20.0))
      ->capture_default_str();
  verb->add_option("--genus", options->genus,
                   "Tunnels. auto: cut those narrower than 5 mm; keep: cut none; a number: cut the narrowest until so "
                   "many are left")
      ->check(CLI::IsMember({"auto", "keep"}) | CLI::Range(0, 1000))
      ->capture_default_str();
  auto* tube_flag =
      verb->add_flag("--tube", options->tube, "A ring × sector grid along the main axis (left ventricle)");
  verb->add_option("--rings", options->rings, "Rings of a tube, base to apex")
      ->check(CLI::Range(3, 1000))
      ->needs(tube_flag)
      ->capture_default_str();
  verb->add_option("--sectors", options->sectors, "Vertices of a ring")
      ->check(CLI::Range(6, 1000))
      ->needs(tube_flag)
      ->capture_default_str();
  verb->add_option("--axis", options->axis, "X,Y,Z direction from the base to the apex (LPS)")
      ->delimiter(',')
      ->expected(3)
      ->needs(tube_flag);
  auto* base = verb->add_option("--base", options->base, "X,Y,Z point on the axis where the rings begin (LPS mm)")
                   ->delimiter(',')
                   ->expected(3)
                   ->needs(tube_flag);
  auto* apex = verb->add_option("--apex", options->apex, "X,Y,Z point towards which the axis runs from --base")
                   ->delimiter(',')
                   ->expected(3)
                   ->needs(base);
  base->needs(apex);
  verb->add_flag("--capped", options->capped, "Close the tube's base with a flat fan")->needs(tube_flag);
  verb->add_option("--outer-label", options->outer_label,
                   "Label of the wall around it: adds a second sheet (epicardium) to the mesh")
      ->check(CLI::PositiveNumber)
      ->needs(tube_flag);
  verb->callback([options, &asked] {
    if (options->in.empty() && options->consensus.empty())
      throw CLI::RequiredError("MASK, or --consensus with several subjects");
    if (options->tube && !options->consensus.empty())
      throw CLI::ValidationError("--consensus", "is not for --tube, whose rings are alike in all subjects");
    if (!options->axis.empty() && Vec3(options->axis.data()).norm() < 1e-9)
      throw CLI::ValidationError("--axis", "needs a direction other than 0,0,0");
    if (options->base == options->apex && !options->base.empty())
      throw CLI::ValidationError("--apex", "needs a point other than --base");
    asked.run = [options](Progress& progress) { return make_template_file(*options, progress); };
  });
}

}  // namespace homolog
