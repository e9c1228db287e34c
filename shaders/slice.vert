// A plane with the image on it, as a rectangle of two triangles. Positions in the grids are affine in the rectangle,
// so they are worked out in double on the CPU and only interpolated here.

uniform mat4 eye_from_mm, clip_from_eye;
uniform vec3 centre_mm, right_mm, down_mm;           // middle of the rectangle and from there to the middles of its edges
uniform vec3 image_centre, image_right, image_down;  // the same in voxels of the image, its outer corner at 0
out vec3 image_position;

#ifdef LABELS
uniform vec3 label_centre, label_right, label_down;
out vec3 label_position;
#endif

void main() {
  vec2 corner = vec2(gl_VertexID & 1, gl_VertexID >> 1) * 2.0 - 1.0;
  image_position = image_centre + corner.x * image_right + corner.y * image_down;
#ifdef LABELS
  label_position = label_centre + corner.x * label_right + corner.y * label_down;
#endif
  gl_Position = clip_from_eye * eye_from_mm * vec4(centre_mm + corner.x * right_mm + corner.y * down_mm, 1.0);
}
