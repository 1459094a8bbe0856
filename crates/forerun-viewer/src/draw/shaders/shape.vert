// Where a body is, and nothing else: for shadow maps and outlines.

uniform mat4 viewProjection;

in vec3 position;

in vec4 place;
in vec4 turn;
in vec4 size;

vec3 turned(vec3 v) { return v + 2.0 * cross(turn.xyz, cross(turn.xyz, v) + turn.w * v); }

void main() { gl_Position = viewProjection * vec4(place.xyz + turned(size.xyz * position), 1.0); }
