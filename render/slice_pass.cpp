#include "render/slice_pass.h"

#include <algorithm>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "render/label_colours.h"
#include "render/shaders.h"

namespace homolog {
namespace {

/// The colours of the labels from 1 on, label_colour_count a row, clear where one is hidden. `last`: the largest label.
gl::Texture make_label_colours(const std::map<int, Rgb>* own, const std::set<int>* hidden, int last) {
  const int rows = (last + label_colour_count - 1) / label_colour_count;
  std::vector<float> colours;
  for (int label = 1; label <= rows * label_colour_count; ++label) {
    for (const float channel : label_colour(label, own)) colours.push_back(channel);
    colours.push_back(hidden != nullptr && hidden->contains(label) ? 0.0f : 1.0f);
  }
  gl::Texture texture = gl::Texture::make();
  glBindTexture(GL_TEXTURE_2D, texture.name());
  glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA8, label_colour_count, rows, 0, GL_RGBA, GL_FLOAT, colours.data());
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
  glBindTexture(GL_TEXTURE_2D, 0);
  return texture;
}

/// A plane right between two layers of voxels must not flicker between them where the nearest is drawn.
constexpr float nudge_vox = 1e-3f;

/// Sets the uniforms of the image or of the label map and binds its texture; `name` is "image" or "label".
void set_volume(const gl::Program& program, const std::string& name, GLenum unit, const VolumeTexture* texture,
                const Volume* volume, const PlaneInSpace& part, bool linear) {
  const auto set = [&](const char* what, const auto& value) { program.set((name + what).c_str(), value); };
  if (texture == nullptr) return set("_size", glm::vec3(-1));
  const VolumeGeometry& geometry = volume->geometry;
  const Vec3 centre = geometry.to_voxel(part.plane.centre);
  const auto along = [&](const Vec3& half_mm) -> glm::vec3 {
    return to_glm(geometry.to_voxel(part.plane.centre + half_mm) - centre);
  };
  set("_centre", to_glm(centre + Vec3::Constant(0.5)));
  set("_right", along(part.half_width_mm * part.plane.right));
  set("_down", along(part.half_height_mm * part.plane.down));
  set("_size", to_glm(geometry.dims));
  set("_coordinate", 1.0f / (to_glm(texture->voxels_per_texel) * to_glm(texture->dims)));
  set("_nudge", linear ? 0 : nudge_vox);
  glActiveTexture(GL_TEXTURE0 + unit);
  glBindTexture(GL_TEXTURE_3D, texture->texture.name());
  glTexParameteri(GL_TEXTURE_3D, GL_TEXTURE_MIN_FILTER, linear ? GL_LINEAR : GL_NEAREST);
  glTexParameteri(GL_TEXTURE_3D, GL_TEXTURE_MAG_FILTER, linear ? GL_LINEAR : GL_NEAREST);
}

void set_plane(const gl::Program& program, const PlaneInSpace& part, const Projection& projection) {
  program.set("eye_from_mm", projection.eye_from_mm);
  program.set("clip_from_eye", projection.clip_from_eye);
  program.set("centre_mm", to_glm(part.plane.centre));
  program.set("right_mm", to_glm(part.half_width_mm * part.plane.right));
  program.set("down_mm", to_glm(part.half_height_mm * part.plane.down));
  program.set("plane_opacity", part.opacity);
}

/// grey = (held · value_scale − low) / (high − low), as one product and one sum.
void set_window(const gl::Program& program, const ImageLayer& image, const VolumeTexture* texture) {
  const double width = image.window_high - image.window_low;
  const double gain = width != 0 ? 1 / width : 1e6;
  program.set("window_scale", texture != nullptr ? static_cast<float>(texture->value_scale * gain) : 0);
  program.set("window_offset", static_cast<float>(-image.window_low * gain));
}

}  // namespace

Result<SlicePass> SlicePass::make() {
  auto plain = gl::Program::make(shaders::slice_vert(), shaders::slice_frag());
  if (!plain) return fail(plain.error());
  auto labelled = gl::Program::make(shaders::slice_vert(), shaders::slice_frag(), "#define LABELS\n");
  if (!labelled) return fail(labelled.error());
  SlicePass pass;
  pass.plain_ = std::move(*plain);
  pass.labelled_ = std::move(*labelled);
  pass.no_attributes_ = gl::VertexArray::make();
  pass.label_colours_ = make_label_colours(nullptr, nullptr, 1);
  return pass;
}

void SlicePass::draw(const Scene& scene, const PlaneInSpace& part, const Projection& projection) {
  const ImageLayer& image = scene.image;
  const LabelLayer& labels = scene.labels;
  const VolumeTexture* image_texture = image.volume ? textures_.of(image.volume, image.frame) : nullptr;
  const VolumeTexture* label_texture =
      labels.labels && labels.opacity > 0 ? textures_.of(labels.labels, labels.frame) : nullptr;
  if (image_texture == nullptr && label_texture == nullptr) return;

  const int last =
      label_texture != nullptr ? static_cast<int>(std::clamp(labels.labels->range_max, 1.0, 65535.0)) : last_label_;
  if (label_texture != nullptr && (labels.colours != own_colours_ || labels.hidden != hidden_ || last > last_label_)) {
    own_colours_ = labels.colours;
    hidden_ = labels.hidden;
    last_label_ = last;
    label_colours_ = make_label_colours(own_colours_.get(), hidden_.get(), last);
  }
  const gl::Program& program = label_texture != nullptr ? labelled_ : plain_;
  program.use();
  set_plane(program, part, projection);
  program.set("image", 0);
  set_window(program, image, image_texture);
  if (label_texture != nullptr) {
    program.set("labels", 1);
    program.set("label_colours", 2);
    program.set("label_opacity", labels.opacity);
    program.set("label_scale", label_texture->value_scale);
    glActiveTexture(GL_TEXTURE2);
    glBindTexture(GL_TEXTURE_2D, label_colours_.name());
    set_volume(program, "label", 1, label_texture, labels.labels.get(), part, false);
  }
  set_volume(program, "image", 0, image_texture, image.volume.get(), part, image.linear);
  glBindVertexArray(no_attributes_.name());
  glDrawArrays(GL_TRIANGLE_STRIP, 0, 4);
}

}  // namespace homolog
