// With LABELS defined a label map lies over the image. Two programs and no branch: software rendering runs both sides
// of a branch. Nearest or linear is the samplers' choice.

uniform sampler3D image;
uniform vec3 image_size;        // voxels; -1 where there is none
uniform vec3 image_coordinate;  // texture coordinates of a voxel
uniform float image_nudge;
uniform float plane_opacity;
uniform float window_scale, window_offset;  // grey of what the texture holds

in vec3 image_position;
out vec4 colour;

bool inside(vec3 position, vec3 size) {
  return all(greaterThanEqual(position, vec3(-1e-3))) && all(lessThanEqual(position, size + 1e-3));
}

#ifdef LABELS
uniform sampler3D labels;
uniform sampler2D label_colours;
uniform vec3 label_size, label_coordinate;
uniform float label_nudge;
uniform float label_scale;  // label of what the texture holds
uniform float label_opacity;

in vec3 label_position;

float label_at(vec3 position) {
  float held = texture(labels, (position + label_nudge) * label_coordinate).r;
  return inside(position, label_size) ? floor(held * label_scale + 0.5) : 0.0;
}

// Twice as opaque along a label's edge, one pixel wide inside it: the edge stays readable where the fill is faint.
vec4 label_layer() {
  float label = label_at(label_position);
  vec3 right = dFdx(label_position), up = dFdy(label_position);
  bool edge = label_at(label_position + right) != label || label_at(label_position - right) != label ||
              label_at(label_position + up) != label || label_at(label_position - up) != label;
  float cover = label > 0.0 ? min(edge ? 2.0 * label_opacity : label_opacity, 1.0) : 0.0;
  int index = max(int(label) - 1, 0), row = textureSize(label_colours, 0).x;
  vec4 colour = texelFetch(label_colours, ivec2(index % row, index / row % textureSize(label_colours, 0).y), 0);
  return vec4(colour.rgb, 1.0) * (colour.a * cover);
}
#endif

void main() {
  float held = texture(image, (image_position + image_nudge) * image_coordinate).r;
  float grey = clamp(held * window_scale + window_offset, 0.0, 1.0);
  colour = inside(image_position, image_size) ? vec4(vec3(grey), 1.0) : vec4(0.0);
#ifdef LABELS
  vec4 over = label_layer();
  colour = over + colour * (1.0 - over.a);
#endif
  colour *= plane_opacity;
  if (colour.a == 0.0) discard;
}
