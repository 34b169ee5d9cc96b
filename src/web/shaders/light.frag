// light.frag: the quadratics of light.vert, one image a power.
flat in vec4 power_0, power_1, power_2;

layout(location = 0) out vec4 image_0;
layout(location = 1) out vec4 image_1;
layout(location = 2) out vec4 image_2;

void main() { image_0 = power_0, image_1 = power_1, image_2 = power_2; }
