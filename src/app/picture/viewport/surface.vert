// Prefixed by the version line of the platform.
uniform mat4 u_clip_from_world;

in vec3 a_position;
in vec3 a_normal;
in vec2 a_grid;
in float a_value;
in vec3 a_color;

out vec3 v_position;
out vec3 v_normal;
out vec2 v_grid;
out float v_value;
out vec3 v_color;

void main() {
    v_position = a_position;
    v_normal = a_normal;
    v_grid = a_grid;
    v_value = a_value;
    v_color = a_color;
    gl_Position = u_clip_from_world * vec4(a_position, 1.0);
}
