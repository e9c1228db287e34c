#include "app/lab/bench_pictures.h"

#include <zlib.h>

#include <filesystem>

#include "app/editor/drawing/gallery_pictures.h"
#include "app/editor/work/models/build_study_model.h"
#include "app/lab/median.h"
#include "core/base/processes/process.h"
#include "core/experiment/demo_case.h"
#include "core/mesh/colours.h"
#include "core/volume/volume_io.h"
#include "render/hued_shapes.h"
#include "render/offscreen.h"
#include "render/renderer.h"

namespace homolog {

namespace {

namespace fs = std::filesystem;

/// A smooth volume with some noise, so that it compresses about as a CT does.
Volume made_volume(int nx, int ny, int nz) {
  Volume volume;
  volume.geometry.dims = {nx, ny, nz};
  volume.geometry.spacing_mm = Vec3::Constant(0.8);
  std::vector<std::int16_t> voxels(volume.geometry.voxels());
  std::uint32_t noise = 1;
  std::size_t at = 0;
  for (int k = 0; k < nz; ++k) {
    for (int j = 0; j < ny; ++j) {
      for (int i = 0; i < nx; ++i) {
        noise = noise * 1664525u + 1013904223u;
        const int smooth = ((i - nx / 2) * (i - nx / 2) + (j - ny / 2) * (j - ny / 2)) / (nx + ny) + k;
        voxels[at++] = static_cast<std::int16_t>(smooth % 400 - 100 + static_cast<int>(noise >> 28));
      }
    }
  }
  volume.data = std::move(voxels);
  volume.range_min = -100;
  volume.range_max = 315;
  return volume;
}

double inflate_ms(const fs::path& path) {
  const auto start = std::chrono::steady_clock::now();
  gzFile file = ::gzopen(path.c_str(), "rb");
  if (file == nullptr) return 0;
  std::vector<char> buffer(std::size_t{1} << 20);
  while (::gzread(file, buffer.data(), static_cast<unsigned>(buffer.size())) > 0) {
  }
  ::gzclose(file);
  return milliseconds(std::chrono::steady_clock::now() - start);
}

/// Opening a 512×512×200 int16 .nii.gz until its first slice is drawn, against its decompression alone.
Json opening_figures(Renderer& renderer) {
  const ScratchFolder folder("homolog-bench");
  const fs::path path = folder.path / "made.nii.gz";
  if (auto written = write_volume(made_volume(512, 512, 200), path); !written) return written.error().sentence();
  const double inflate = inflate_ms(path);
  const auto start = std::chrono::steady_clock::now();
  auto read = read_volume(path);
  Json figures{{"decompression_ms", inflate}};
  if (read) {
    Scene scene;
    scene.image.volume = std::make_shared<const Volume>(std::move(read->volume));
    std::tie(scene.image.window_low, scene.image.window_high) = default_window(*scene.image.volume);
    SliceView view;
    view.centre = scene.image.volume->geometry.bounds_mm().center();
    (void)renderer.draw(scene, view, {0, 0, 640, 400, 1});
    figures["read_and_drawn_ms"] = milliseconds(std::chrono::steady_clock::now() - start);
  }
  return figures;
}

/// A frame of the Models mode while its 24 shapes of 2,500 vertices are turned, in a window of 1280×800.
Json gallery_frame_ms(Renderer& renderer, Framebuffer& framebuffer) {
  const ScratchFolder folder("homolog-bench");
  StudyModelRequest request;
  for (int number = 1; number <= 24; ++number) {
    StudyCase one;
    one.name = "kidney-" + std::to_string(number);
    one.file = folder.path / (one.name + ".ply");
    if (auto written = write_mesh_file(phantom_truth(Organ::kidney, number).front(), one.file); !written)
      return written.error().sentence();
    request.cases.push_back(std::move(one));
  }
  Progress progress;
  ModelsState state;
  show_model(state, build_study_model(request, progress).model);
  if (!state.made.model) return "no model could be made";
  state.gallery.turning = true;
  GalleryPictures pictures;
  const ModelsLayout layout = models_layout(make_layout(1280, 800, 1, {std::nullopt, true, true}));
  const auto frame = [&](int) {
    state.gallery.camera = turned(state.gallery.camera, 3, 1);
    pictures.draw(state, layout, 1, renderer);
    framebuffer.bind();
    pictures.copy(layout, 800);
    (void)framebuffer.read();  // waits until all is drawn
  };
  frame(0);
  return median_ms(frame, 1000);
}

}  // namespace

Json picture_figures() {
  auto context = OffscreenContext::make();
  if (!context) return context.error().sentence();
  auto framebuffer = Framebuffer::make(1280, 800);
  auto renderer = Renderer::make();
  if (!framebuffer || !renderer) return "no framebuffer or renderer to be had";
  (*framebuffer)->bind();
  const auto document = demo_document(Organ::kidney, 1);
  if (!document) return document.error().sentence();

  Scene scene;
  scene.image.volume = std::make_shared<const Volume>(made_volume(256, 256, 256));
  scene.image.window_low = -100;
  scene.image.window_high = 300;
  MeshLayer layer;
  layer.topology = document->structure()->the_template->topology;
  layer.colours = hued_surface(vertex_hues(*layer.topology));
  const Vec3 centre = scene.image.volume->geometry.bounds_mm().center();
  Points points =
      document->view()->shape.points->rowwise() - bounds_of(*document->view()->shape.points).center().transpose();
  points.rowwise() += centre.transpose();
  scene.meshes.push_back(layer);
  const std::array<SliceView, 3> slices{{{centre, Vec3::UnitX(), Vec3::UnitY(), 0.5},
                                         {centre, Vec3::UnitY(), -Vec3::UnitZ(), 0.5},
                                         {centre, Vec3::UnitX(), -Vec3::UnitZ(), 0.5}}};
  Camera3D camera;
  camera.target = centre;
  const auto drag_frame = [&](int k) {
    points(0, 0) += 1e-3;
    scene.meshes.front().points = std::make_shared<const Points>(points);
    scene.meshes.front().points_revision = static_cast<std::uint64_t>(k) + 1;
    for (int view = 0; view < 3; ++view) {
      (void)(*renderer)->draw(scene, slices[view], {640 * (view % 2), 400 * (view / 2), 640, 400, 1});
    }
    (void)(*renderer)->draw(scene, camera, {640, 400, 640, 400, 1});
    (void)(*framebuffer)->read();  // waits until all is drawn
  };
  drag_frame(0);
  Json figures{{"four_views_1280x800_drag_frame_ms", median_ms(drag_frame, 1000)}};
  if (auto window = Framebuffer::make(1280, 800, 1))
    figures["gallery_24_shapes_turned_frame_ms"] = gallery_frame_ms(**renderer, **window);
  figures["opening_512x512x200_nii_gz"] = opening_figures(**renderer);
  return figures;
}

}  // namespace homolog
