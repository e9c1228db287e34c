uniform sampler2D layer;  // premultiplied
uniform vec2 origin_px;   // of the target in the framebuffer
uniform float opacity;

out vec4 colour;

void main() {
  colour = texelFetch(layer, ivec2(gl_FragCoord.xy - origin_px), 0) * opacity;
  if (colour.a == 0.0) discard;
}
