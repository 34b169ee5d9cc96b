// ranges.frag: depths of a Gaussian's support; the largest of both numbers is kept.
flat in vec2 range;

layout(location = 0) out vec2 kept;

void main() { kept = range; }
