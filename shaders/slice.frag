uniform sampler3D image, labels;
uniform sampler2D label_colours;
uniform vec3 image_size, label_size;                      // voxels; 0 where there is none
uniform vec3 image_voxels_per_texel, label_voxels_per_texel;
uniform vec3 image_texels, label_texels;
uniform float image_scale, label_scale;                   // intensity of what the texture holds as 1
uniform float window_low, window_gain;                    // grey = (intensity - low) * gain
uniform float label_opacity;
uniform int linear;

in vec3 image_position, label_position;
out vec4 colour;

// A plane right between two layers of voxels must not flicker between them.
const float margin = 1e-3;

bool inside(vec3 position, vec3 size) {
  return all(greaterThan(position, vec3(-margin))) && all(lessThan(position, size + margin)) && size.x > 0.0;
}

float nearest(sampler3D volume, vec3 position, vec3 voxels_per_texel, vec3 texels) {
  vec3 texel = clamp(floor((position + margin) / voxels_per_texel), vec3(0.0), texels - 1.0);
  return texelFetch(volume, ivec3(texel), 0).r;
}

int label_at(vec3 position) {
  if (!inside(position, label_size)) return 0;
  return int(floor(nearest(labels, position, label_voxels_per_texel, label_texels) * label_scale + 0.5));
}

// Twice as opaque along a label's edge, one pixel wide inside it: the edge stays readable where the fill is faint.
float label_cover(int label) {
  vec3 right = dFdx(label_position), up = dFdy(label_position);
  bool edge = label_at(label_position + right) != label || label_at(label_position - right) != label ||
              label_at(label_position + up) != label || label_at(label_position - up) != label;
  return edge ? min(2.0 * label_opacity, 1.0) : label_opacity;
}

void main() {
  colour = vec4(0.0);
  if (inside(image_position, image_size)) {
    float sampled = linear != 0 ? texture(image, image_position / (image_voxels_per_texel * image_texels)).r
                                : nearest(image, image_position, image_voxels_per_texel, image_texels);
    colour = vec4(vec3(clamp((sampled * image_scale - window_low) * window_gain, 0.0, 1.0)), 1.0);
  }
  int label = label_at(label_position);
  if (label > 0 && label_opacity > 0.0) {
    float cover = label_cover(label);
    vec3 tint = texelFetch(label_colours, ivec2((label - 1) % textureSize(label_colours, 0).x, 0), 0).rgb;
    colour = vec4(tint, 1.0) * cover + colour * (1.0 - cover);
  }
  if (colour.a == 0.0) discard;
}
