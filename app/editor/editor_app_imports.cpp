#include <cmath>
#include <utility>

#include "app/editor/editor_app.h"
#include "core/mesh/landmark_io.h"
#include "core/mesh/surface_search.h"
#include "core/template/template_file.h"

// Files that are read into the case on the screen, and the template that is made and then used: beside the window,
// since they may be large or far away.

namespace homolog {

namespace {

/// The values that a mesh file has for the template's vertices.
Result<VertexScalars> stiffness_in(const std::filesystem::path& path, const Topology& topology) {
  auto read = read_mesh_file(path);
  if (!read) return fail(read.error());
  const std::string name = path.filename().string();
  std::optional<VertexScalars> factors = read->stiffness;
  if (!factors && read->arrays.size() == 1) factors = read->arrays.begin()->second;
  if (!factors) {
    std::string names;
    for (const auto& [array, values] : read->arrays) names += (names.empty() ? "" : ", ") + array;
    return fail(name, names.empty()
                          ? "holds no value per vertex; save one as \"stiffness\"."
                          : "holds several values per vertex (" + names + "); name the one to take \"stiffness\".");
  }
  if (read->triangles.rows() > 0 && read->triangles != topology.triangles())
    return fail(name,
                "its faces are not those of the template, so its vertices are others. Save the values on the "
                "template's own mesh.");
  return std::move(*factors);
}

/// Landmarks in the template's own frame, with the place of each on its surface.
struct OnTemplate {
  std::vector<std::pair<std::string, SurfacePoint>> landmarks;
  std::string away;  ///< "apex (34 mm), base (40 mm)": what lies off the surface
};

Result<OnTemplate> landmarks_on(const std::filesystem::path& path, const Template& reference) {
  constexpr double most_mm = 10;
  const auto read = read_landmarks(path);
  if (!read) return fail(read.error());
  const SurfaceSearch search({reference.topology, reference.points});
  OnTemplate found;
  for (const Landmark& landmark : *read) {
    const auto nearest = search.nearest(landmark.position);
    if (nearest.distance_mm <= most_mm)
      found.landmarks.emplace_back(landmark.name, nearest.at);
    else
      found.away += (found.away.empty() ? "" : ", ") + landmark.name + " (" +
                    std::to_string(std::lround(nearest.distance_mm)) + " mm)";
  }
  return found;
}

Result<void> write_template(const TemplateMaking& making, const std::filesystem::path& path) {
  const TemplateSettings& settings = making.settings;
  const auto provenance =
      settings.tube ? provenance_of(making.source, settings.tube_options) : provenance_of(making.source, settings.mask);
  return write_mesh_file(template_file(*making.mesh, provenance), path);
}

}  // namespace

template <class Read, class Take>
void EditorApp::read_for_case(const std::filesystem::path& path, Read read, Take take) {
  work_.queue(path.string(),
              [this, path, read = std::move(read), take = std::move(take),
               number = session_number_](Progress&) -> Result<Then> {
                auto got = read(path);
                if (!got) return fail(got.error());
                using Value = typename decltype(got)::value_type;
                const auto value = std::make_shared<const Value>(std::move(*got));
                return Then([this, path, take, value, number] {
                  if (number == session_number_) return take(*value);
                  add_notice(state_, path.filename().string() + " was read for the case before this one, and left out.",
                             false);
                });
              });
}

void EditorApp::import_landmarks(const std::filesystem::path& path) {
  read_for_case(
      path, [](const auto& file) { return read_landmarks(file); },
      [this, name = path.filename().string()](const std::vector<Landmark>& read) {
        const auto known = landmarks_of_template(read, *snapshot_->document);
        if (known.empty())
          return add_notice(state_,
                            name + ": none of its names is a landmark of the template. Rename them as in the list.");
        stop_playing();
        for (std::size_t i = 0; i < known.size(); ++i)
          session_->apply(PlaceLandmark{known[i].name, known[i].position}, i > 0);
        if (known.size() < read.size())
          add_notice(state_,
                     name + ": " + std::to_string(read.size() - known.size()) + " of " + std::to_string(read.size()) +
                         " names are not landmarks of the template. They were left out.",
                     false);
      });
}

void EditorApp::import_stiffness(const std::filesystem::path& path) {
  const auto topology = snapshot_->document->reference->topology;
  read_for_case(
      path, [topology](const auto& file) { return stiffness_in(file, *topology); },
      [this](const VertexScalars& factors) {
        session_->apply(SetStiffnessFactors{std::make_shared<const VertexScalars>(factors)});
      });
}

void EditorApp::import_template_landmarks(const std::filesystem::path& path) {
  read_for_case(
      path, [reference = snapshot_->document->reference](const auto& file) { return landmarks_on(file, *reference); },
      [this, name = path.filename().string()](const OnTemplate& found) {
        const Document& document = *snapshot_->document;
        bool joined = false;
        for (const auto& [landmark, at] : found.landmarks) {
          const Vec3 on_mesh = at.interpolate(*document.reference->topology, *document.shape().points).transpose();
          session_->apply(SetTemplateLandmark{landmark, on_mesh}, std::exchange(joined, true));
        }
        if (!found.away.empty())
          add_notice(state_, name + ": left out, because they lie away from the template: " + found.away +
                                 ". Check that the points are in the template's own coordinates.");
      });
}

void EditorApp::use_made_template(const std::filesystem::path& path) {
  const auto making = template_maker_.latest();
  if (!making || !making->mesh) return;
  exports_.start(
      path, [making, path](Progress&) { return write_template(*making, path); },
      [this, making, path] {
        if (template_maker_.latest() == making) {  // and no other was begun meanwhile
          making_shown_ = false;
          template_maker_.forget();
        }
        OpenRequest request;
        request.template_source = path.string();
        opener_.start(std::move(request));
      });
}

}  // namespace homolog
