uniform sampler2D layer;        // premultiplied
uniform sampler2D layer_depth;  // of its nearest surface
uniform vec2 origin_px;         // of the target in the framebuffer

out vec4 colour;

void main() {
  ivec2 at = ivec2(gl_FragCoord.xy - origin_px);
  colour = texelFetch(layer, at, 0);
  if (colour.a == 0.0) discard;
  gl_FragDepth = texelFetch(layer_depth, at, 0).r;
}
