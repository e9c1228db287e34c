#include "core/model/measures/evaluation.h"

#include <algorithm>
#include <ostream>

#include "core/base/files/files.h"

namespace homolog {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

namespace {

void add_measures(const std::vector<std::pair<std::string, Measures>>& all, Json& values) {
  for (const auto& [name, measures] : all) {
    Json means = Json::array(), errors = Json::array();
    for (const Measured& m : measures) {
      means.push_back(m.mean);
      errors.push_back(m.standard_error);
    }
    values[name] = std::move(means);
    values[name + "_se"] = std::move(errors);
  }
}

void write_table(const Evaluation& evaluation, std::ostream& out) {
  out.precision(17);
  out << "modes";
  for (const auto* part : {&evaluation.at_every, &evaluation.at_modes})
    for (const auto& [name, measures] : *part) out << ',' << name << ',' << name << "_se";
  for (const auto& [name, measures] : evaluation.shapeworks)
    out << ",shapeworks_" << name << ",shapeworks_" << name << "_se";
  out << '\n';
  const std::size_t counts = evaluation.at_every.front().second.size();
  for (std::size_t m = 0; m < counts; ++m) {
    out << m + 1;
    for (const auto& [name, measures] : evaluation.at_every)
      out << ',' << measures[m].mean << ',' << measures[m].standard_error;
    const auto asked = std::find(evaluation.modes.begin(), evaluation.modes.end(), static_cast<int>(m) + 1);
    const auto at = static_cast<std::size_t>(asked - evaluation.modes.begin());
    for (const auto* part : {&evaluation.at_modes, &evaluation.shapeworks}) {
      for (const auto& [name, measures] : *part) {
        out << ',';
        if (asked != evaluation.modes.end())
          out << measures[at].mean << ',' << measures[at].standard_error;
        else
          out << ',';
      }
    }
    out << '\n';
  }
}

}  // namespace

const Measures* Evaluation::find(const std::string& name) const {
  for (const auto* part : {&at_every, &at_modes})
    for (const auto& [known, measures] : *part)
      if (known == name) return &measures;
  return nullptr;
}

const Measures* Evaluation::find_shapeworks(const std::string& name) const {
  for (const auto& [known, measures] : shapeworks)
    if (known == name) return &measures;
  return nullptr;
}

Result<Evaluation> evaluate_model(const PrincipalComponents& components,
                                  const std::shared_ptr<const Topology>& topology, const EvaluationOptions& options,
                                  Progress* progress) {
  const auto& [modes, samples, seed] = options;
  const Eigen::Index most = components.shapes() - 2;
  if (most < 1 || std::any_of(modes.begin(), modes.end(), [most](int m) { return m < 1 || m > most; }))
    return fail("", "measures need three shapes that differ, and one more for each further mode; add shapes");
  Evaluation evaluation;
  evaluation.shapes = components.shapes();
  evaluation.vertices = components.vertices();
  evaluation.total_variance_mm2 = components.variances().sum();
  evaluation.modes = modes;
  const Measures shares = compactness(components);
  evaluation.at_every = {{"compactness", shares},
                         {"generalization_rms", generalisation_rms(components)},
                         {"specificity_rms", specificity_rms(components, samples, seed)}};
  const auto part = [&](double from, double to) {
    if (progress != nullptr) progress->part(from, to);
  };
  const double surface_to = topology ? 0.7 : 0.2;  // the surface distance takes most of the time
  part(0, surface_to);
  auto general = generalisation(components, topology, modes, progress);
  if (!general) return fail(general.error());
  part(surface_to, (1 + surface_to) / 2);
  auto specific = specificity_mean(components, modes, samples, seed, false, progress);
  if (!specific) return fail(specific.error());
  part((1 + surface_to) / 2, 1);
  auto shapeworks = specificity_mean(components, modes, samples, seed, true, progress);
  if (!shapeworks) return fail(shapeworks.error());
  Measures shares_at_modes;
  for (const int m : modes) shares_at_modes.push_back(shares[static_cast<std::size_t>(m) - 1]);
  evaluation.at_modes = {{"generalization", general->mean}, {"specificity", std::move(*specific)}};
  evaluation.shapeworks = {{"compactness", std::move(shares_at_modes)},
                           {"generalization", std::move(general->mean)},
                           {"specificity", std::move(*shapeworks)}};
  if (topology) evaluation.at_modes.emplace_back("generalization_surface", std::move(general->surface));
  if (progress != nullptr) progress->part(0, 1);
  return evaluation;
}

Json to_json(const Evaluation& evaluation) {
  Json values = {{"shapes", evaluation.shapes}, {"vertices", evaluation.vertices}};
  values["total_variance_mm2"] = evaluation.total_variance_mm2;
  add_measures(evaluation.at_every, values);
  values["modes"] = evaluation.modes;
  add_measures(evaluation.at_modes, values);
  Json shapeworks = Json::object();
  add_measures(evaluation.shapeworks, shapeworks);
  values["shapeworks"] = std::move(shapeworks);
  return values;
}

Result<void> write_evaluation(const Evaluation& evaluation, const fs::path& path) {
  return write_whole_file(path, [&](std::ostream& out) {
    if (path.extension() == ".json")
      out << to_json(evaluation).dump(2) << '\n';
    else
      write_table(evaluation, out);
    return Result<void>();
  });
}

}  // namespace homolog
