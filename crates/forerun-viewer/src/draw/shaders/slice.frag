uniform sampler2D image;

in vec2 spot;

layout (location = 0) out vec4 colour;

void main() { colour = texture(image, spot); }
