#include "patches.h"

#include "fault.h"
#include "names.h"

#include <algorithm>
#include <cmath>

namespace skinslide {

// ---- Topology ----

std::vector<bool> Topology::verticesOf(const std::vector<int32_t> &faces) const {
    std::vector<bool> vertices(vertexCount, false);
    for (int32_t face : faces) {
        for (size_t corner = faceStart[face]; corner < faceStart[face + 1]; corner++)
            vertices[faceIndices[corner]] = true;
    }
    return vertices;
}

std::vector<int32_t> Topology::facesWithin(const std::vector<bool> &vertices) const {
    std::vector<int32_t> faces;
    for (size_t face = 0; face < faceCount(); face++) {
        auto first = faceIndices.begin() + faceStart[face], last = faceIndices.begin() + faceStart[face + 1];
        if (first != last && std::all_of(first, last, [&](int32_t vertex) { return vertices[vertex]; }))
            faces.push_back(static_cast<int32_t>(face));
    }
    return faces;
}

// ---- Controls ----

namespace {

const float *pointerTo(const std::vector<float> &values) {
    return values.empty() ? nullptr : values.data();
}

bool isDensity(float value) {
    return std::isfinite(value) && value > 0;
}

bool isDistance(float value) {
    return value >= 0;
}

bool isNumber(float value) {
    return std::isfinite(value);
}

void checkDensities(const std::vector<float> &values, const std::string &what) {
    for (size_t point = 0; point < values.size(); point++) {
        if (!isDensity(values[point]))
            throw fault("%s at point %zu is %g; it must be finite and above 0", what.c_str(), point, values[point]);
    }
}

// Paint times map, where there are both.
void multiply(const std::vector<float> &mapped, std::vector<float> *values) {
    if (values->empty())
        *values = mapped;
    else
        for (size_t point = 0; point < mapped.size(); point++)
            (*values)[point] *= mapped[point];
}

} // namespace

skinslide_controls Controls::native() const {
    skinslide_controls controls = SKINSLIDE_CONTROLS_DEFAULT;
    controls.vertex_density = pointerTo(vertexDensity);
    controls.face_density = pointerTo(faceDensity);
    controls.edge_density = pointerTo(edgeDensity);
    controls.edges = edges.empty() ? nullptr : edges.data();
    controls.edge_count = static_cast<int32_t>(edgeDensity.size());
    controls.weight = pointerTo(weight);
    controls.envelope = envelope;
    controls.max_distance = pointerTo(maxDistance);
    return controls;
}

// ---- Faces ----

namespace {

std::vector<int32_t> primvarFaces(const Primvar &primvar, const Topology &topology, double time) {
    std::string name = primvar.name(), type = primvar.attribute().typeName().GetString();
    if (type != "bool[]" && type != "int[]" && type != "float[]")
        throw fault("%s is %s; it must be bool[], int[] or float[]", name.c_str(), type.c_str());
    TfToken interpolation = primvar.interpolation();
    if (interpolation != names().uniform && interpolation != names().vertex)
        throw fault("%s has interpolation %s; it must be uniform (by face) or vertex", name.c_str(), interpolation.GetText());
    VtValue value = primvar.flattened(time);
    if (value.IsEmpty())
        throw fault("%s has no value", name.c_str());
    std::vector<bool> chosen = positive(value, name);
    bool byFace = interpolation == names().uniform;
    checkLength(name, chosen.size(), byFace ? topology.faceCount() : topology.vertexCount, byFace ? "faces" : "points");
    std::vector<int32_t> faces;
    for (size_t face = 0; byFace && face < chosen.size(); face++) {
        if (chosen[face])
            faces.push_back(static_cast<int32_t>(face));
    }
    if (!byFace)
        faces = topology.facesWithin(chosen);
    if (faces.empty())
        throw fault("has no faces: %s is above 0 %s", name.c_str(), byFace ? "on no face" : "on all points of no face");
    return faces;
}

std::vector<int32_t> subsetFaces(const Prim &child, const Topology &topology) {
    const char *path = child.path().GetText();
    TfToken type = child.typeName();
    if (type != names().geomSubset)
        throw fault("has no faces: %s is a %s, not a GeomSubset", path,
                    type.IsEmpty() ? "prim without a type" : type.GetText());
    VtValue element = child.attribute(names().elementType).at(Attribute::defaultTime);
    TfToken token = element.IsHolding<TfToken>() ? element.UncheckedGet<TfToken>() : names().face;
    if (token != names().face)
        throw fault("the GeomSubset %s has elementType %s; it must be face", path, token.GetText());
    std::string what = child.path().GetString() + ".indices";
    std::vector<int32_t> faces = integers(unchanging(child.attribute(names().indices), what), what);
    std::sort(faces.begin(), faces.end());
    faces.erase(std::unique(faces.begin(), faces.end()), faces.end());
    if (faces.empty())
        throw fault("has no faces: the GeomSubset %s is empty", path);
    for (int32_t face : {faces.front(), faces.back()}) {
        if (face < 0 || static_cast<size_t>(face) >= topology.faceCount())
            throw fault("the GeomSubset %s has face %d, but the mesh has %zu faces", path, face, topology.faceCount());
    }
    return faces;
}

// Values may vary where the faces do not, as those of a mesh that some tool resampled.
void checkStill(const Primvar &primvar, const std::vector<int32_t> &faces, const Topology &topology) {
    for (double time : primvar.times()) {
        if (primvarFaces(primvar, topology, time) != faces)
            throw fault("%s chooses other faces at frame %s; patches are fixed", primvar.name().c_str(),
                        frameText(time).c_str());
    }
}

} // namespace

void Patch::readFaces(Composition &composition, const Prim &mesh, const Topology &topology) {
    Primvar primvar(mesh, names().primvar(_name, "patch"));
    if (primvar.authored()) {
        _faces = primvarFaces(primvar, topology, Attribute::first);
        checkStill(primvar, _faces, topology);
        return;
    }
    TfTokenVector children = mesh.childNames();
    if (std::find(children.begin(), children.end(), TfToken(_name)) == children.end())
        throw fault("has no faces: there is neither %s nor a GeomSubset %s under the mesh",
                    names().primvar(_name, "patch").GetText(), _name.c_str());
    _faces = subsetFaces(composition.prim(mesh.path().AppendChild(TfToken(_name)), mesh.clips()), topology);
}

// ---- The set-up ----

Patch::Patch(Composition &composition, const Prim &mesh, const std::string &name, const Topology &topology,
             const Params &params)
    : _name(name), _liveEnvelope(params.envelope), _weight(mesh, names().primvar(name, "weight")),
      _maxDistance(mesh, names().primvar(name, "maxDistance")), _density(mesh, names().primvar(name, "forceDensity")),
      _weightMap(composition, mesh, name, "weight"), _densityMap(composition, mesh, name, "forceDensity"),
      _envelope(mesh.attribute(names().property(name, "envelope"))),
      _edgeDensity(mesh.attribute(names().property(name, "edgeForceDensities"))) {
    readFaces(composition, mesh, topology);
    _insideVertex = topology.verticesOf(_faces);
    _insideFace.assign(topology.faceCount(), false);
    for (int32_t face : _faces)
        _insideFace[face] = true;
    _boundary = readToken(mesh, "boundary", boundaryTokens);
    _holes = readToken(mesh, "holes", holesTokens);
    _rule = readToken(mesh, "forceDensityRule", ruleTokens);
    _interpolation = readToken(mesh, "interpolation", interpolationTokens);
    if (!params.interpolation.empty()) {
        auto found = std::find(interpolationTokens.begin(), interpolationTokens.end(), params.interpolation);
        _interpolation = static_cast<int>(found - interpolationTokens.begin());
    }
    readCorners(mesh, topology);
    readEdges(mesh);
    for (const Attribute *control : std::initializer_list<const Attribute *>{
             &_envelope, &_edgeDensity, &_weight.attribute(), &_maxDistance.attribute(), &_density.attribute()}) {
        if (control->source() == Attribute::Source::Spline)
            throw fault("%s is a spline, which a .skinslide file cannot read; bake the stage instead, or sample it",
                        control->name().c_str());
    }
    _weightMap.settle(topology, _faces);
    _densityMap.settle(topology, _faces);
    controlsAt(Attribute::first, topology);
}

std::set<std::string> Patch::files() const {
    std::set<std::string> files = _weightMap.files();
    files.insert(_densityMap.files().begin(), _densityMap.files().end());
    return files;
}

int Patch::readToken(const Prim &mesh, const char *setting, const std::vector<std::string> &tokens) const {
    Attribute attribute = mesh.attribute(names().property(_name, setting));
    VtValue value = attribute.at(Attribute::first);
    if (value.IsEmpty())
        return 0; // the fallback is the first of its tokens
    std::string token = value.IsHolding<TfToken>()       ? value.UncheckedGet<TfToken>().GetString()
                        : value.IsHolding<std::string>() ? value.UncheckedGet<std::string>()
                                                         : TfStringify(value);
    auto found = std::find(tokens.begin(), tokens.end(), token);
    if (found == tokens.end())
        throw fault("%s is '%s'; it must be one of %s", attribute.name().c_str(), token.c_str(),
                    TfStringJoin(tokens.begin(), tokens.end(), ", ").c_str());
    return static_cast<int>(found - tokens.begin());
}

void Patch::readCorners(const Prim &mesh, const Topology &topology) {
    Attribute attribute = mesh.attribute(names().property(_name, "corners"));
    const char *name = attribute.name().c_str();
    _corners = integers(unchanging(attribute, attribute.name()), attribute.name());
    if (_corners.empty())
        return;
    if (_corners.size() != 4)
        throw fault("%s has %zu values; it must have 4", name, _corners.size());
    for (size_t i = 0; i < 4; i++) {
        if (_corners[i] < 0 || static_cast<size_t>(_corners[i]) >= topology.vertexCount)
            throw fault("%s has point %d, but the mesh has %zu points", name, _corners[i], topology.vertexCount);
        if (std::count(_corners.begin(), _corners.end(), _corners[i]) > 1)
            throw fault("%s has point %d more than once", name, _corners[i]);
    }
}

void Patch::readEdges(const Prim &mesh) {
    Attribute attribute = mesh.attribute(names().property(_name, "edges"));
    _edges = integers(unchanging(attribute, attribute.name()), attribute.name());
    if (_edges.size() % 2)
        throw fault("%s has %zu values; it must hold pairs of point indices", attribute.name().c_str(), _edges.size());
}

skinslide_patch_setup Patch::native(const Controls &controls) const {
    skinslide_patch_setup setup = {};
    setup.name = _name.c_str();
    setup.faces = _faces.data();
    setup.face_count = static_cast<int32_t>(_faces.size());
    setup.corners = _corners.empty() ? nullptr : _corners.data();
    setup.boundary = static_cast<skinslide_boundary>(_boundary);
    setup.holes = static_cast<skinslide_holes>(_holes);
    setup.rule = static_cast<skinslide_rule>(_rule);
    setup.interpolation = static_cast<skinslide_interpolation>(_interpolation);
    setup.controls = controls.native();
    return setup;
}

// ---- Controls over time ----

bool Patch::varies() const {
    return _envelope.varies() || _weight.varies() || _maxDistance.varies() || _density.varies() || _edgeDensity.varies() ||
           _weightMap.varies() || _densityMap.varies();
}

std::vector<double> Patch::times() const {
    std::vector<double> times;
    auto append = [&](const std::vector<double> &more) { times.insert(times.end(), more.begin(), more.end()); };
    if (_envelope.varies())
        append(_envelope.times());
    append(_weight.times());
    append(_maxDistance.times());
    append(_density.times());
    append(_weightMap.times());
    append(_densityMap.times());
    if (_edgeDensity.varies())
        append(_edgeDensity.times());
    return times;
}

Controls Patch::controlsAt(double time, const Topology &topology) const {
    Controls controls;
    takeEnvelope(time, &controls);
    controls.weight = paintedByVertex(_weight, time, topology, isNumber, "a number");
    multiply(_weightMap.at(time, topology, _faces), &controls.weight);
    controls.maxDistance = paintedByVertex(_maxDistance, time, topology, isDistance, "0 or more");
    takeDensity(time, topology, &controls);
    takeEdges(time, &controls);
    return controls;
}

void Patch::takeEnvelope(double time, Controls *controls) const {
    VtValue value = _envelope.at(time);
    double envelope = 1;
    if (!value.IsEmpty()) {
        if (!value.CanCast<double>())
            throw fault("%s is %s; it must be a float", _envelope.name().c_str(), TfStringify(value).c_str());
        envelope = value.Cast<double>().Get<double>();
    }
    if (!std::isfinite(envelope))
        throw fault("%s is %g", _envelope.name().c_str(), envelope);
    controls->envelope = static_cast<float>(_liveEnvelope == 1 ? envelope : envelope * _liveEnvelope);
}

// The values of a float primvar; one where it is constant, none where there is none.
std::vector<float> Patch::painted(const Primvar &primvar, double time, const Topology &topology, bool byFace) const {
    if (!primvar.authored())
        return {};
    std::string name = primvar.name(), type = primvar.attribute().typeName().GetString();
    if (type != "float[]" && type != "float")
        throw fault("%s is %s; it must be float[]", name.c_str(), type.c_str());
    TfToken interpolation = primvar.interpolation();
    if (interpolation != names().vertex && interpolation != names().constant && !(byFace && interpolation == names().uniform))
        throw fault("%s has interpolation %s; it must be vertex%s or constant", name.c_str(), interpolation.GetText(),
                    byFace ? " or uniform" : "");
    VtValue value = primvar.flattened(time);
    if (value.IsEmpty())
        throw fault("%s has no value", name.c_str());
    std::vector<float> values = floats(value, name);
    if (interpolation == names().vertex)
        checkLength(name, values.size(), topology.vertexCount, "points");
    else if (interpolation == names().uniform)
        checkLength(name, values.size(), topology.faceCount(), "faces");
    else if (values.size() != 1)
        throw fault("%s has interpolation constant but %zu values; is vertex missing?", name.c_str(), values.size());
    return values;
}

// Values off the patch do not count, since paint is often 0 there: they are replaced by ones that the core accepts.
std::vector<float> Patch::paintedByVertex(const Primvar &primvar, double time, const Topology &topology, bool (*isGood)(float),
                                          const char *wanted) const {
    std::vector<float> values = painted(primvar, time, topology, false);
    bool constant = values.size() == 1 && primvar.interpolation() == names().constant;
    for (size_t i = 0; i < values.size(); i++) {
        bool counts = constant || _insideVertex[i];
        if (counts && !isGood(values[i]))
            throw fault("%s[%zu] is %g; it must be %s", primvar.name().c_str(), i, values[i], wanted);
        values[i] = counts ? values[i] : 0;
    }
    return constant ? std::vector<float>(topology.vertexCount, values[0]) : values;
}

void Patch::takeDensity(double time, const Topology &topology, Controls *controls) const {
    std::vector<float> values = painted(_density, time, topology, true);
    TfToken interpolation = _density.interpolation();
    const std::vector<bool> &inside = interpolation == names().uniform ? _insideFace : _insideVertex;
    for (size_t i = 0; i < values.size(); i++) {
        bool counts = interpolation == names().constant || inside[i];
        if (counts && !isDensity(values[i]))
            throw fault("%s[%zu] is %g; it must be finite and above 0", _density.name().c_str(), i, values[i]);
        values[i] = counts ? values[i] : 1;
    }
    if (interpolation == names().vertex)
        controls->vertexDensity = std::move(values);
    else if (interpolation == names().uniform) // a constant changes no ratio
        controls->faceDensity = std::move(values);
    std::vector<float> mapped = _densityMap.at(time, topology, _faces);
    checkDensities(mapped, _densityMap.name());
    multiply(mapped, &controls->vertexDensity);
    checkDensities(controls->vertexDensity, _density.name() + " times " + _densityMap.name());
}

void Patch::takeEdges(double time, Controls *controls) const {
    VtValue value = _edgeDensity.at(time);
    std::vector<float> factors = floats(value, _edgeDensity.name());
    if (factors.size() != _edges.size() / 2)
        throw fault("%s has %zu values, but %s has %zu pairs", _edgeDensity.name().c_str(), factors.size(),
                    names().property(_name, "edges").GetText(), _edges.size() / 2);
    for (size_t k = 0; k < factors.size(); k++) {
        if (!isDensity(factors[k]))
            throw fault("%s[%zu], for edge %d-%d, is %g; it must be finite and above 0", _edgeDensity.name().c_str(), k,
                        _edges[2 * k], _edges[2 * k + 1], factors[k]);
    }
    controls->edges = _edges;
    controls->edgeDensity = std::move(factors);
}

} // namespace skinslide
