// Prefixed by the version line of the platform and the precision.
uniform vec3 u_eye;
uniform vec3 u_right;
uniform vec3 u_up;
uniform vec2 u_range;        // field values at the ends of the colour table
uniform sampler2D u_table;
uniform int u_material;      // 0 tissue surface, 1 cut face, 2 implant, 3 chest wall
uniform bool u_cut;          // take away what lies in front of both planes
uniform vec3 u_planes[2];
uniform vec3 u_axis;
uniform bool u_net;
uniform vec2 u_grid_centre;
uniform float u_pocket;      // radius of the pocket's edge on the grid [cells]; 0: no line
uniform float u_foot;        // radius of the circle in which the implant meets the wall [mm]

in vec3 v_position;
in vec3 v_normal;
in vec2 v_grid;
in float v_value;
in vec3 v_color;

out vec4 out_color;

float line(float at, float width) {
    float from_line = abs(fract(at + 0.5) - 0.5);
    return 1.0 - smoothstep(0.35, 1.15, from_line / max(width, 1e-6));
}

// The springs: edges strong, diagonals weak, `spacing` cells apart.
float springs(vec2 grid, vec2 width, float spacing) {
    vec2 q = grid / spacing;
    vec2 w = width / spacing;
    float edges = max(line(q.x, w.x), line(q.y, w.y));
    float diagonals = max(line(q.x + q.y, w.x + w.y), line(q.x - q.y, w.x + w.y));
    return max(edges, 0.35 * diagonals);
}

vec3 linear_of(vec3 srgb) { return pow(srgb, vec3(2.2)); }

void main() {
    vec3 from_axis = v_position - u_axis;
    if (u_cut && dot(u_planes[0], from_axis) > 0.0 && dot(u_planes[1], from_axis) > 0.0) discard;

    // Derivatives are computed before any branch that differs between neighbouring pixels.
    vec2 width = fwidth(v_grid);
    bool has_net = v_grid.y > -0.5;

    bool has_value = v_value > -1.0e8;
    vec3 base = v_color;
    if (has_value) {
        float t = clamp((v_value - u_range.x) / (u_range.y - u_range.x), 0.0, 1.0);
        base = texture(u_table, vec2(t, 0.5)).rgb;
    }
    base = linear_of(base);

    vec3 view = normalize(u_eye - v_position);
    vec3 normal = normalize(v_normal);
    if (dot(normal, view) < 0.0) normal = -normal;

    // The lamps move with the camera, like surgical lamps; the sky is fixed to the body.
    vec3 back = normalize(cross(u_right, u_up));
    vec3 key = normalize(0.55 * back + 0.75 * u_up - 0.50 * u_right + vec3(0.0, 0.0, 0.25));
    vec3 fill = normalize(0.8 * back + 0.2 * u_up + 0.8 * u_right);
    vec3 ambient = mix(vec3(0.20, 0.18, 0.18), vec3(0.40, 0.42, 0.45), 0.5 + 0.5 * normal.z);

    if (u_material == 0) ambient *= 0.88;
    bool soft = u_material == 0 || u_material == 1;
    float wrap = soft ? 0.22 : 0.1;
    float lit = clamp((dot(normal, key) + wrap) / (1.0 + wrap), 0.0, 1.0);
    float filled = clamp(dot(normal, fill), 0.0, 1.0);
    vec3 light = ambient + vec3(0.74, 0.72, 0.69) * lit + vec3(0.10, 0.11, 0.13) * filled;
    if (u_material == 0 && !has_value) {
        // Subsurface scattering: light through the skin is red where the surface turns away.
        light += vec3(0.10, 0.025, 0.015) * (1.0 - lit);
    }
    if (u_material == 1) light = mix(light, vec3(1.0), 0.7);
    // Ambient occlusion where the implant meets the wall.
    if (u_material == 2) light *= 1.0 - 0.45 * exp(-max(v_position.z, 0.0) / 9.0);
    if (u_material == 3) light *= 1.0 - 0.50 * exp(-abs(length(from_axis.xy) - u_foot) / 11.0);
    vec3 color = base * light;

    vec3 halfway = normalize(key + view);
    float facing = clamp(dot(normal, halfway), 0.0, 1.0);
    float rim = pow(1.0 - clamp(dot(normal, view), 0.0, 1.0), 3.0);
    if (u_material == 0) {
        color += vec3(0.10) * pow(facing, 18.0) + vec3(0.09, 0.08, 0.08) * rim;
    } else if (u_material == 2) {
        // Pearl: a narrow highlight on a wide one, a cool rim.
        color += vec3(0.22) * pow(facing, 90.0) + vec3(0.05) * pow(facing, 12.0);
        color += vec3(0.10, 0.14, 0.20) * rim;
    }

    if (u_net && u_material == 0 && has_net) {
        float level = max(log2(9.0 * max(width.x, width.y)), 0.0);
        float spacing = exp2(floor(level));
        vec2 grid = v_grid - u_grid_centre;
        float net = mix(
            springs(grid, width, spacing),
            springs(grid, width, 2.0 * spacing),
            smoothstep(0.3, 0.9, fract(level)));
        color = mix(color, color * 0.30, 0.42 * net);
    } else if (u_net && u_material == 1 && has_net) {
        // The cells in the cut: fewer along the skin from afar, all of them through the thickness.
        float spacing = exp2(floor(max(log2(9.0 * width.x), 0.0)));
        vec2 cell = vec2(spacing, 1.0);
        float net = springs(v_grid / cell, width / cell, 1.0);
        color = mix(color, color * 0.30, 0.42 * net);
    }

    if (u_pocket > 0.0 && u_material == 0 && has_net) {
        float across = abs(length(v_grid - u_grid_centre) - u_pocket);
        float edge = 1.0 - smoothstep(0.8, 1.8, across / max(max(width.x, width.y), 1e-6));
        color = mix(color, vec3(0.05, 0.05, 0.09), 0.75 * edge);
    }

    out_color = vec4(pow(clamp(color, 0.0, 1.0), vec3(1.0 / 2.2)), 1.0);
}
