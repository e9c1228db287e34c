#include "render/slice_pass.h"

#include <string>
#include <vector>

#include "render/label_colours.h"
#include "render/shaders.h"

namespace homolog {
namespace {

gl::Texture make_label_colours() {
  std::vector<float> colours;
  for (int label = 1; label <= kLabelColours; ++label) {
    for (const float channel : label_colour(label)) colours.push_back(channel);
  }
  gl::Texture texture = gl::Texture::make();
  glBindTexture(GL_TEXTURE_2D, texture.name());
  glTexImage2D(GL_TEXTURE_2D, 0, GL_RGB8, kLabelColours, 1, 0, GL_RGB, GL_FLOAT, colours.data());
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
  glBindTexture(GL_TEXTURE_2D, 0);
  return texture;
}

glm::vec3 to_glm(const std::array<int, 3>& v) {
  return {v[0], v[1], v[2]};
}

/// Sets the uniforms of the image or of the label map and binds its texture; `name` is "image" or "label".
void set_volume(const gl::Program& program, const std::string& name, int unit, const VolumeTexture* texture,
                const std::shared_ptr<const Volume>& volume, const PlaneInSpace& part) {
  const auto set = [&](const char* what, const auto& value) { program.set((name + what).c_str(), value); };
  if (texture == nullptr) return set("_size", glm::vec3(0));
  const VolumeGeometry& geometry = volume->geometry;
  const Vec3 centre = geometry.to_voxel(part.plane.centre);
  const auto along = [&](const Vec3& half_mm) -> glm::vec3 {
    return homolog::to_glm(geometry.to_voxel(part.plane.centre + half_mm) - centre);
  };
  set("_centre", homolog::to_glm(centre + Vec3::Constant(0.5)));
  set("_right", along(part.half_width_mm * part.plane.right));
  set("_down", along(part.half_height_mm * part.plane.down));
  set("_size", to_glm(geometry.dims));
  set("_voxels_per_texel", to_glm(texture->voxels_per_texel));
  set("_texels", to_glm(texture->dims));
  set("_scale", texture->value_scale);
  glActiveTexture(GL_TEXTURE0 + static_cast<GLenum>(unit));
  glBindTexture(GL_TEXTURE_3D, texture->texture.name());
}

}  // namespace

Result<SlicePass> SlicePass::make() {
  auto program = gl::Program::make(shaders::slice_vert(), shaders::slice_frag());
  if (!program) return fail(program.error());
  SlicePass pass;
  pass.program_ = std::move(*program);
  pass.no_attributes_ = gl::VertexArray::make();
  pass.label_colours_ = make_label_colours();
  return pass;
}

void SlicePass::draw(const Scene& scene, const PlaneInSpace& part, const Projection& projection) {
  const ImageLayer& image = scene.image;
  const LabelLayer& labels = scene.labels;
  const VolumeTexture* image_texture = image.volume ? textures_.of(image.volume, image.frame) : nullptr;
  const VolumeTexture* label_texture =
      labels.labels && labels.opacity > 0 ? textures_.of(labels.labels, labels.frame) : nullptr;
  if (image_texture == nullptr && label_texture == nullptr) return;

  program_.use();
  program_.set("eye_from_mm", projection.eye_from_mm);
  program_.set("clip_from_eye", projection.clip_from_eye);
  program_.set("centre_mm", to_glm(part.plane.centre));
  program_.set("right_mm", to_glm(part.half_width_mm * part.plane.right));
  program_.set("down_mm", to_glm(part.half_height_mm * part.plane.down));
  program_.set("image", 0);
  program_.set("labels", 1);
  program_.set("label_colours", 2);
  const double width = image.window_high - image.window_low;
  program_.set("window_low", static_cast<float>(image.window_low));
  program_.set("window_gain", width != 0 ? static_cast<float>(1 / width) : 1e6f);
  program_.set("label_opacity", labels.opacity);
  program_.set("linear", image.linear ? 1 : 0);
  glActiveTexture(GL_TEXTURE2);
  glBindTexture(GL_TEXTURE_2D, label_colours_.name());
  set_volume(program_, "label", 1, label_texture, labels.labels, part);
  set_volume(program_, "image", 0, image_texture, image.volume, part);
  glBindVertexArray(no_attributes_.name());
  glDrawArrays(GL_TRIANGLE_STRIP, 0, 4);
}

}  // namespace homolog
