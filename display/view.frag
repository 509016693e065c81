// view.glsl for all pixels of the viewport: software renderers rasterise more cheaply than they dispatch and store. Defines: there.
#include "view.glsl"

void main() {
  draw_pixel(ivec2(gl_FragCoord.xy));
}
