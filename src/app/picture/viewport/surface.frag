// Prefixed by the version line of the platform and the precision.
uniform vec3 u_eye;
uniform vec3 u_right;
uniform vec3 u_up;
uniform vec2 u_range;        // field values at the ends of the colour table
uniform sampler2D u_table;
uniform int u_material;      // 0 tissue surface, 1 cut face, 2 implant, 3 chest wall, 4 torso
uniform bool u_cut;          // take away what lies in front of both planes
uniform vec3 u_planes[2];
uniform vec3 u_axis;
uniform bool u_net;
uniform vec2 u_grid_centre;
uniform float u_cell;        // width of a cell at rest [mm]
uniform int u_areola;        // 0 none, 1 in its own colour, 2 its edge
uniform float u_pocket;      // radius of the pocket's edge on the grid [cells]; 0: no line
uniform float u_lower;       // that radius by the edge's distance from the centre downwards
uniform vec4 u_end;          // plane at which the torso ends behind: normal, and height of the origin over it [mm]
uniform vec3 u_behind[2];    // background at the lower and at the upper edge
uniform vec2 u_window;       // lower edge and height [pixels]
uniform vec2 u_foot;         // half-axes of the ellipse in which the implant meets the wall, across and along the body [mm]

in vec3 v_position;
in vec3 v_normal;
in vec2 v_grid;
in float v_value;
in vec3 v_color;

out vec4 out_color;

const float AREOLA = 20.0;     // radius at rest [mm]
const float NIPPLE = 5.5;
const float ENDING = 45.0;     // depth over which the end of the torso fades [mm]
const float EPIDERMIS = 0.7;   // drawn thickness [mm], more than the true one
const float LOBULE = 4.5;      // width of a lobule of fat at rest [mm]
const float PATTERN = 1000.0;  // step between the values of the patterns of cut faces

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

// Powers of 2.2 and 1 / 2.2 within 2 % of the full scale, at a fraction of the time.
vec3 linear_of(vec3 srgb) { return srgb * srgb * (0.8 + 0.2 * srgb); }
vec3 srgb_of(vec3 linear) { vec3 root = sqrt(linear); return root * (1.13 - 0.13 * root); }

vec2 scattered(vec2 cell) {
    return fract(sin(vec2(dot(cell, vec2(127.1, 311.7)), dot(cell, vec2(269.5, 183.3)))) * 43758.5453);
}

// Lobules: distance from the septum between the two nearest seeds [widths of a lobule], and a number of the lobule, 0 to 1.
vec2 lobule(vec2 at) {
    vec2 cell = floor(at);
    float first = 8.0, second = 8.0, number = 0.0;
    for (int j = -1; j <= 1; j++) for (int i = -1; i <= 1; i++) {
        vec2 other = cell + vec2(i, j);
        vec2 seed = scattered(other);
        float away = distance(other + 0.15 + 0.7 * seed, at);
        if (away < first) { second = first; first = away; number = seed.x; }
        else second = min(second, away);
    }
    return vec2(second - first, number);
}

// Epidermis and lobules on a cut face, from places at rest.
vec3 patterned(vec3 base, float pixel) {
    float pattern = floor(v_value / PATTERN + 0.0005);
    float depth = v_value - PATTERN * pattern;
    if (pattern == 1.0) {
        float edge = max(EPIDERMIS, 1.2 * pixel);
        float epidermis = 1.0 - smoothstep(edge - 0.5 * pixel, edge + 0.5 * pixel, depth);
        return mix(base, vec3(0.46, 0.20, 0.14), 0.75 * epidermis);
    }
    if (pattern == 2.0) {
        vec2 along = vec2(-v_normal.y, v_normal.x);
        float place = v_grid.y > -0.5 ? v_grid.x * u_cell : dot(along, v_position.xy);
        vec2 found = lobule(vec2(place / LOBULE, depth / (0.72 * LOBULE)));
        float septum = 1.0 - smoothstep(0.05, 0.22, found.x);
        // From afar one tone.
        float near = 1.0 - smoothstep(0.8, 2.0, pixel);
        vec3 tone = base * (1.0 + 0.16 * near * (found.y - 0.5));
        return mix(tone, base * vec3(1.06, 0.90, 0.72), 0.55 * near * septum);
    }
    return base;
}

void main() {
    // Derivatives are computed before any branch that differs between neighbouring pixels.
    vec2 width = fwidth(v_grid);
    bool has_net = v_grid.y > -0.5;

    bool skin = u_material == 0 || u_material == 4;
    vec3 view = normalize(u_eye - v_position);
    vec3 normal = normalize(v_normal);
    if (dot(normal, view) < 0.0) normal = -normal;
    float facing = clamp(dot(normal, view), 0.0, 1.0);
    // Distance from the silhouette of a round surface [pixels]; large on flat surfaces.
    float square = facing * facing;
    float from_silhouette = u_material == 1 ? 0.0 : square / max(fwidth(square), 1e-5);

    vec3 from_axis = v_position - u_axis;
    float in_front = min(dot(u_planes[0], from_axis), dot(u_planes[1], from_axis));
    float coverage = u_cut ? clamp(0.5 - in_front / max(fwidth(in_front), 1e-6), 0.0, 1.0) : 1.0;
    if (coverage <= 0.0) discard;

    bool has_value = skin && v_value > -1.0e8;
    vec3 base = v_color;
    if (has_value) {
        float t = clamp((v_value - u_range.x) / (u_range.y - u_range.x), 0.0, 1.0);
        vec3 scale = texture(u_table, vec2(t, 0.5)).rgb;
        base = u_material == 4 ? mix(base, scale, smoothstep(0.5, 1.0, -1.0 - v_grid.y)) : scale;
    }
    base = linear_of(base);
    if (u_material == 1) base = patterned(base, 0.7 * length(fwidth(v_position)));

    float from_middle = has_net && u_material == 0 ? length(v_grid - u_grid_centre) : 1.0e6;
    float grid_pixel = max(max(width.x, width.y), 1e-6);
    float areola = 0.0;
    if (u_areola == 1) {
        // The edge is soft, the nipple a little darker.
        float radius = u_material == 4 ? v_grid.x : from_middle * u_cell;
        areola = 1.0 - smoothstep(AREOLA - 1.6, AREOLA + 0.8, radius);
        float nipple = 1.0 - smoothstep(NIPPLE - 1.2, NIPPLE + 1.2, radius);
        base = mix(base, vec3(0.42, 0.17, 0.13), areola * (0.62 + 0.2 * nipple));
    }

    // The lamps move with the camera, like surgical lamps; the sky is fixed to the body.
    vec3 back = normalize(cross(u_right, u_up));
    vec3 key = normalize(0.55 * back + 0.50 * u_up - 0.75 * u_right + vec3(0.0, 0.0, 0.15));
    vec3 fill = normalize(0.8 * back + 0.2 * u_up + 0.8 * u_right);
    vec3 from_behind = normalize(0.9 * u_up - 0.35 * back + 0.45 * u_right);
    vec3 ambient = mix(vec3(0.20, 0.18, 0.18), vec3(0.40, 0.42, 0.45), 0.5 + 0.5 * normal.z);

    if (skin) ambient *= 0.88;
    bool soft = skin || u_material == 1;
    float wrap = soft ? 0.24 : 0.20;
    float lit = clamp((dot(normal, key) + wrap) / (1.0 + wrap), 0.0, 1.0);
    float filled = clamp(dot(normal, fill), 0.0, 1.0);
    vec3 light = ambient + vec3(0.78, 0.76, 0.73) * lit + vec3(0.10, 0.11, 0.13) * filled;
    if (skin && !has_value) {
        // Subsurface scattering: light through the skin is red where the surface turns away.
        light += vec3(0.10, 0.025, 0.015) * (1.0 - lit);
    }
    if (u_material == 1) light = mix(light, vec3(1.0), 0.7);
    // Contact shadows: where the implant meets the wall, and in the crease of the skin around it.
    float foot = u_foot.x;
    float from_foot = length(from_axis.xy * vec2(1.0, u_foot.x / max(u_foot.y, 1.0)));
    float beside = from_foot - foot;
    if (u_material == 2) light *= 1.0 - 0.45 * exp(-max(v_value, 0.0) / 9.0);
    if (u_material == 3) light *= 1.0 - 0.55 * exp(-abs(beside) / 13.0);
    if (u_material == 0) {
        float crease = (beside - 0.10 * foot) / (0.16 * foot + 1.0);
        float near = 1.0 / (1.0 + crease * crease);
        light *= 1.0 - (has_value ? 0.07 : 0.14) * near * near;
    }
    vec3 color = base * light;

    vec3 halfway = normalize(key + view);
    float glance = clamp(dot(normal, halfway), 0.0, 1.0);
    float aside = 1.0 - facing;
    float rim = aside * aside * aside * clamp(dot(normal, from_behind) + 0.2, 0.0, 1.0);
    if (skin) {
        float glance2 = glance * glance;
        float glance8 = glance2 * glance2 * glance2 * glance2;
        color += vec3(0.07) * glance8 * glance8 * (1.0 - 0.5 * areola) + vec3(0.16, 0.145, 0.14) * rim;
    } else if (u_material == 2) {
        // Matt gel, deeper in the middle; the shell is paler where the eye looks along it.
        color *= mix(1.0, 0.90, facing) * vec3(1.0, 0.99, 0.965);
        color += vec3(0.045) * pow(glance, 10.0);
        float shell = pow(1.0 - facing, 2.5);
        color = mix(color, vec3(0.60, 0.66, 0.72) * (0.35 + 0.65 * lit), 0.55 * shell);
    }
    // Outline of the silhouettes; not on flat skin beside the dome, where the eye looks along the skin.
    if (u_material != 1) {
        float beyond = smoothstep(0.9, 1.2, from_foot / max(foot, 1.0));
        float round = 1.0 - beyond * smoothstep(0.90, 0.985, normal.z);
        float outline = 1.0 - smoothstep(0.6, 1.9, from_silhouette);
        float shade = 1.0 - smoothstep(0.0, 6.0, from_silhouette);
        // A torso has creases within its outline, where lines would be hatching.
        float line_share = u_material == 4 ? 0.0 : 0.50;
        color *= 1.0 - round * (line_share * outline + 0.12 * shade);
    }

    if (u_net && u_material == 0 && has_net) {
        float level = max(log2(9.0 * grid_pixel), 0.0);
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

    if (u_areola == 2) {
        float across = abs(from_middle - AREOLA / u_cell);
        float edge = 1.0 - smoothstep(0.6, 1.5, across / grid_pixel);
        color = mix(color, vec3(0.20, 0.06, 0.05), 0.7 * edge);
    }
    if (u_pocket > 0.0) {
        // The lower half of the edge is that of an ellipse: its gauge and the length of the gauge's gradient.
        vec2 at = v_grid - u_grid_centre;
        float q = at.y < 0.0 ? u_lower : 1.0;
        float gauge = length(vec2(at.x, q * at.y));
        float slope = length(vec2(at.x, q * q * at.y)) / max(gauge, 1.0e-3);
        float across = abs(gauge - u_pocket) / max(slope, 1.0e-3);
        float edge = 1.0 - smoothstep(0.7, 1.5, across / grid_pixel);
        color = mix(color, vec3(0.05, 0.05, 0.09), 0.6 * edge);
    }

    vec3 shown = srgb_of(clamp(color, 0.0, 1.0));
    if (u_material == 4) {
        // From the side, the torso has no edge where it ends.
        float from_end = smoothstep(0.0, ENDING, dot(u_end.xyz, v_position) + u_end.w);
        float aside = 1.0 - smoothstep(0.35, 0.75, abs(dot(u_end.xyz, view)));
        vec3 behind = mix(u_behind[0], u_behind[1], (gl_FragCoord.y - u_window.x) / u_window.y);
        shown = mix(shown, behind, aside * (1.0 - from_end));
    }
    out_color = vec4(shown, coverage);
}
