// The paper's method with Eigen's LDL^T, analysed once, and a walk from where a neighbour was found.
#include <Eigen/SparseCholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <ctime>
#include <map>
#include <utility>
#include <vector>

namespace {

double now() {
    timespec time;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
    return time.tv_sec + 1e-9 * time.tv_nsec;
}

struct Edge {
    int a, b;
};

struct Slot {
    int edge;
    double *value; // of the matrix, to which the density is added
    double sign;
};

struct Border {
    int edge, row, fixed;
};

struct Query {
    int vertex, from; // from: the query whose face this one starts in, -1 for none
};

struct Sheet {
    int vertices, faces;
    const int *corners;
    std::vector<Edge> edges;
    std::vector<int> number, beside; // of a vertex among the free, -1 fixed; the face over each side, -1 none
    std::vector<double> rest, uv;    // [vertices][2]
    std::vector<Query> queries;
    std::vector<int> found; // by query
    Eigen::SparseMatrix<double> matrix;
    Eigen::MatrixX2d right;
    std::vector<Slot> slots;
    std::vector<Border> borders;
    Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factor;
};

void findSides(Sheet &sheet) {
    std::map<std::pair<int, int>, int> side;
    sheet.beside.assign(3 * sheet.faces, -1);
    for (int corner = 0; corner < 3 * sheet.faces; corner++) {
        int a = sheet.corners[corner], b = sheet.corners[corner - corner % 3 + (corner + 1) % 3];
        auto other = side.find({b, a});
        if (other == side.end()) {
            side[{a, b}] = corner;
            sheet.edges.push_back({a, b});
        } else {
            sheet.beside[corner] = other->second / 3;
            sheet.beside[other->second] = corner / 3;
        }
    }
}

int numberFree(Sheet &sheet, const double *border) {
    int free = 0;
    sheet.uv.assign(border, border + 2 * sheet.vertices);
    for (int v = 0; v < sheet.vertices; v++)
        sheet.number.push_back(std::isnan(border[2 * v]) ? free++ : -1);
    return free;
}

void analyse(Sheet &sheet, int free) {
    std::vector<Eigen::Triplet<double>> entries;
    for (const Edge &edge : sheet.edges) {
        int a = sheet.number[edge.a], b = sheet.number[edge.b];
        if (a >= 0 && b >= 0)
            entries.emplace_back(std::max(a, b), std::min(a, b), 1);
    }
    for (int row = 0; row < free; row++)
        entries.emplace_back(row, row, 1);
    sheet.matrix.resize(free, free);
    sheet.matrix.setFromTriplets(entries.begin(), entries.end());
    sheet.factor.analyzePattern(sheet.matrix);
    sheet.right.resize(free, 2);
    for (int e = 0; e < (int)sheet.edges.size(); e++) {
        int a = sheet.number[sheet.edges[e].a], b = sheet.number[sheet.edges[e].b];
        if (a >= 0)
            sheet.slots.push_back({e, &sheet.matrix.coeffRef(a, a), 1});
        if (b >= 0)
            sheet.slots.push_back({e, &sheet.matrix.coeffRef(b, b), 1});
        if (a >= 0 && b >= 0)
            sheet.slots.push_back({e, &sheet.matrix.coeffRef(std::max(a, b), std::min(a, b)), -1});
        else if (a >= 0 || b >= 0)
            sheet.borders.push_back({e, a >= 0 ? a : b, a >= 0 ? sheet.edges[e].b : sheet.edges[e].a});
    }
}

void embed(Sheet &sheet, const float *points) {
    std::vector<double> density(sheet.edges.size());
    for (size_t e = 0; e < density.size(); e++) {
        const float *a = points + 3 * sheet.edges[e].a, *b = points + 3 * sheet.edges[e].b;
        double x = (double)a[0] - b[0], y = (double)a[1] - b[1], z = (double)a[2] - b[2];
        density[e] = 1 / std::sqrt(x * x + y * y + z * z);
    }
    std::fill(sheet.matrix.valuePtr(), sheet.matrix.valuePtr() + sheet.matrix.nonZeros(), 0);
    for (const Slot &slot : sheet.slots)
        *slot.value += slot.sign * density[slot.edge];
    sheet.right.setZero();
    for (const Border &border : sheet.borders)
        for (int axis = 0; axis < 2; axis++)
            sheet.right(border.row, axis) += density[border.edge] * sheet.uv[2 * border.fixed + axis];
    sheet.factor.factorize(sheet.matrix);
    Eigen::MatrixX2d solved = sheet.factor.solve(sheet.right);
    for (int v = 0; v < sheet.vertices; v++)
        for (int axis = 0; axis < 2 && sheet.number[v] >= 0; axis++)
            sheet.uv[2 * v + axis] = solved(sheet.number[v], axis);
}

// Queries breadth first, each from one beside it.
void order(Sheet &sheet) {
    std::vector<std::vector<int>> around(sheet.vertices);
    for (const Edge &edge : sheet.edges) {
        around[edge.a].push_back(edge.b);
        around[edge.b].push_back(edge.a);
    }
    std::vector<bool> seen(sheet.vertices);
    for (int first = 0; first < sheet.vertices; first++) {
        if (seen[first] || sheet.number[first] < 0)
            continue;
        seen[first] = true;
        sheet.queries.push_back({first, -1});
        for (size_t q = sheet.queries.size() - 1; q < sheet.queries.size(); q++)
            for (int v : around[sheet.queries[q].vertex])
                if (!seen[v] && sheet.number[v] >= 0) {
                    seen[v] = true;
                    sheet.queries.push_back({v, (int)q});
                }
    }
    sheet.found.assign(sheet.queries.size(), 0);
}

double area(const double *a, const double *b, const double *p) {
    return (b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0]);
}

// Across the side that p is farthest outside of, until it is outside of none.
int walk(const Sheet &sheet, int face, const double *p, double weights[3]) {
    for (int step = 0; step <= sheet.faces; step++) {
        int worst = 0;
        for (int side = 0; side < 3; side++) {
            const int *corner = sheet.corners + 3 * face;
            weights[side] = area(&sheet.uv[2 * corner[side]], &sheet.uv[2 * corner[(side + 1) % 3]], p);
            worst = weights[side] < weights[worst] ? side : worst;
        }
        int next = sheet.beside[3 * face + worst];
        if (weights[worst] >= 0 || next < 0)
            break;
        face = next;
    }
    return face;
}

} // namespace

extern "C" {

Sheet *eigen_create(int vertices, int faces, const int *corners, const float *rest, const double *border) {
    auto *sheet = new Sheet{};
    sheet->vertices = vertices, sheet->faces = faces, sheet->corners = corners;
    findSides(*sheet);
    analyse(*sheet, numberFree(*sheet, border));
    embed(*sheet, rest);
    sheet->rest = sheet->uv;
    order(*sheet);
    return sheet;
}

void eigen_rest(const Sheet *sheet, double *uv) {
    std::copy(sheet->rest.begin(), sheet->rest.end(), uv);
}

void eigen_frame(Sheet *sheet, const float *points, double *uv, float *slid, double *seconds) {
    double start = now();
    embed(*sheet, points);
    double embedded = now();
    std::vector<std::array<double, 3>> weights(sheet->queries.size());
    for (size_t q = 0; q < sheet->queries.size(); q++) {
        int from = sheet->queries[q].from;
        sheet->found[q] =
            walk(*sheet, from < 0 ? 0 : sheet->found[from], &sheet->rest[2 * sheet->queries[q].vertex], weights[q].data());
    }
    double located = now();
    std::copy(points, points + 3 * sheet->vertices, slid);
    for (size_t q = 0; q < sheet->queries.size(); q++) {
        const int *corner = sheet->corners + 3 * sheet->found[q];
        const double *w = weights[q].data(), whole = w[0] + w[1] + w[2];
        for (int axis = 0; axis < 3; axis++)
            slid[3 * sheet->queries[q].vertex + axis] =
                (float)((w[1] * points[3 * corner[0] + axis] + w[2] * points[3 * corner[1] + axis] +
                         w[0] * points[3 * corner[2] + axis]) /
                        whole);
    }
    double end = now();
    seconds[0] = embedded - start, seconds[1] = located - embedded, seconds[2] = end - located;
    std::copy(sheet->uv.begin(), sheet->uv.end(), uv);
}
}
