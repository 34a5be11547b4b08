#include "meshes.h"

#include "fault.h"
#include "names.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

namespace skinslide {

bool PatchedMesh::controlsVary() const {
    return std::any_of(patches.begin(), patches.end(), [](const Patch &patch) { return patch.varies(); });
}

namespace {

// ---- Finding meshes ----

struct Found {
    Prim prim;
    std::vector<std::string> patches;
    std::string whyNot; // empty: it can be slid
};

std::vector<std::string> patchNames(const Prim &prim) {
    std::vector<std::string> patches;
    for (const std::string &schema : prim.apiSchemas()) {
        if (TfStringStartsWith(schema, names().schemaPrefix))
            patches.push_back(schema.substr(names().schemaPrefix.size()));
    }
    return patches;
}

// Walks the composed layer once.
class Search {
  public:
    explicit Search(Composition &composition) : _composition(composition) {
        _defined[SdfPath::AbsoluteRootPath()] = true;
        composition.traverse([this](const Prim &prim) { return visit(prim); });
        for (Found &found : _found) {
            SdfPath instancer = prototypeOf(found.prim.path());
            if (found.whyNot.empty() && !instancer.IsEmpty())
                found.whyNot = TfStringPrintf("is a prototype of the point instancer %s, whose instances share its points",
                                              instancer.GetText());
        }
    }

    const std::vector<Found> &found() const {
        return _found;
    }

  private:
    bool visit(const Prim &prim) {
        SdfSpecifier specifier = prim.specifier();
        if (!prim.active() || specifier == SdfSpecifierClass)
            return false;
        SdfPath parent = prim.path().GetParentPath();
        _defined[prim.path()] = _defined[parent] && specifier == SdfSpecifierDef;
        _instance[prim.path()] = !_instance[parent].IsEmpty() ? _instance[parent]
                                 : prim.instanceable()        ? prim.path()
                                                              : SdfPath();
        TfToken type = prim.typeName();
        if (type == names().pointInstancer) {
            for (const SdfPath &target : _composition.targets(prim.path().AppendProperty(names().prototypes)))
                _prototypes[target] = prim.path();
        }
        std::vector<std::string> patches = patchNames(prim);
        if (!patches.empty())
            _found.push_back({prim, patches, whyNot(prim, type)});
        return true;
    }

    std::string whyNot(const Prim &prim, const TfToken &type) {
        const SdfPath &instance = _instance[prim.path().GetParentPath()];
        if (!instance.IsEmpty())
            return TfStringPrintf("is inside an instance, whose points are shared; author instanceable = false on %s",
                                  instance.GetText());
        if (!_defined[prim.path()])
            return "is not defined, there are only overs; is the path right, and does the cache below it open?";
        if (type != names().mesh)
            return TfStringPrintf("is a %s; SkinSlideAPI applies to Mesh only",
                                  type.IsEmpty() ? "prim without a type" : type.GetText());
        return "";
    }

    SdfPath prototypeOf(const SdfPath &path) const {
        for (const SdfPath &prefix : path.GetPrefixes()) {
            auto found = _prototypes.find(prefix);
            if (found != _prototypes.end())
                return found->second;
        }
        return SdfPath();
    }

    Composition &_composition;
    std::vector<Found> _found;
    std::map<SdfPath, bool> _defined;
    std::map<SdfPath, SdfPath> _instance, _prototypes;
};

// The layer whose computed points these are, where another .skinslide file slides the mesh already.
std::string slidBy(const Attribute &points) {
    const SdfLayerRefPtr &layer = points.layer();
    if (!layer || layer->GetFileFormat()->GetFormatId() != TfToken("skinslide"))
        return "";
    std::vector<std::string> ignored;
    return Params::fromArguments(layer->GetFileFormatArguments(), &ignored).live ? layer->GetIdentifier() : "";
}

// ---- Reading one mesh ----

bool isSkinned(Composition &composition, const Prim &prim) {
    if (prim.hasProperty(names().blendShapes))
        return true;
    for (const SdfPath &path : prim.path().GetPrefixes()) {
        if (composition.prim(path).attribute(names().jointIndices).authored())
            return true;
    }
    return false;
}

VtVec3fArray firstPoints(Composition &composition, const Prim &prim, const Attribute &points) {
    if (points.clipped())
        throw Fault("points come from value clips, which a .skinslide file cannot read; bake the stage instead");
    if (points.source() == Attribute::Source::Spline)
        throw Fault("points come from a spline, which a .skinslide file cannot read; bake the stage instead");
    if (points.source() != Attribute::Source::Samples && isSkinned(composition, prim))
        throw Fault("points are skinned by UsdSkel and have no samples; bake the skinning first (usdbakeskinning)");
    VtVec3fArray first = positions(points.at(Attribute::first), "points");
    if (first.empty())
        throw Fault("points has no value");
    return first;
}

void fitFaces(Topology *topology) {
    size_t total = 0;
    for (size_t face = 0; face < topology->faceCount(); face++) {
        if (topology->faceCounts[face] < 0)
            throw fault("face %zu has %d vertices", face, topology->faceCounts[face]);
        topology->faceStart.push_back(total);
        total += static_cast<size_t>(topology->faceCounts[face]);
    }
    topology->faceStart.push_back(total);
    if (total != topology->faceIndices.size())
        throw fault("faceVertexCounts add up to %zu, but faceVertexIndices has %zu values", total,
                    topology->faceIndices.size());
    for (size_t face = 0; face < topology->faceCount(); face++) {
        for (size_t corner = topology->faceStart[face]; corner < topology->faceStart[face + 1]; corner++) {
            int32_t point = topology->faceIndices[corner];
            if (point < 0 || static_cast<size_t>(point) >= topology->vertexCount)
                throw fault("face %zu has point %d, but the mesh has %zu points", face, point, topology->vertexCount);
        }
    }
}

Topology readTopology(const Prim &prim, size_t vertexCount) {
    auto read = [&](const TfToken &name) {
        std::vector<int32_t> values = integers(unchanging(prim.attribute(name), name.GetString()), name.GetString());
        if (values.empty())
            throw fault("%s has no value", name.GetText());
        return values;
    };
    Topology topology;
    topology.vertexCount = vertexCount;
    topology.faceCounts = read(names().faceCounts);
    topology.faceIndices = read(names().faceIndices);
    fitFaces(&topology);
    return topology;
}

VtValue findRest(const Prim &prim, const Attribute &points, std::string *source) {
    Attribute own = prim.attribute(names().restPoints);
    *source = own.name();
    if (own.authored())
        return own.at(Attribute::first);
    for (const TfToken &name : names().restPrimvars) {
        Primvar primvar(prim, name);
        *source = primvar.name();
        if (primvar.authored())
            return primvar.flattened(Attribute::first);
    }
    *source = "points (default)";
    return points.at(Attribute::defaultTime);
}

VtVec3fArray readRest(const Prim &prim, const Attribute &points, size_t vertexCount) {
    std::string source;
    VtValue value = findRest(prim, points, &source);
    if (value.IsEmpty())
        throw Fault("has no rest points: points has samples but no default value, so author the rest pose as "
                    "skinSlide:restPoints or primvars:rest (point3f[], vertex)");
    VtVec3fArray rest = positions(value, source);
    if (rest.size() != vertexCount)
        throw fault("rest points: %s has %zu values, but points has %zu", source.c_str(), rest.size(), vertexCount);
    for (size_t i = 0; i < rest.size(); i++) {
        const GfVec3f &point = rest.cdata()[i];
        if (!std::isfinite(point[0]) || !std::isfinite(point[1]) || !std::isfinite(point[2]))
            throw fault("rest points: %s[%zu] is (%g, %g, %g)", source.c_str(), i, point[0], point[1], point[2]);
    }
    return rest;
}

// primvars:normals win over normals; a constant does not follow from points.
void readNormals(const Prim &prim, PatchedMesh *source) {
    Primvar primvar(prim, names().normalsPrimvar);
    bool isPrimvar = primvar.authored();
    source->normals = isPrimvar ? primvar : Primvar(prim, names().normals);
    const Attribute &attribute = source->normals.attribute();
    source->normalsInterpolation = attribute.token(names().interpolation, isPrimvar ? names().constant : names().vertex);
    source->hasNormals = attribute.authored() && source->normalsInterpolation != names().constant;
    if (source->hasNormals && isPrimvar && primvar.indexed())
        source->blocked.emplace_back(TfToken("primvars:normals:indices"), TfToken("int[]"));
}

// Stale velocities would give wrong motion blur: those that cannot be recomputed are blocked.
void readRates(const Prim &prim, PatchedMesh *source) {
    size_t sampleCount = 2;
    for (const TfToken &name : {names().velocities, names().accelerations}) {
        Attribute attribute = prim.attribute(name);
        if (attribute.authored()) {
            if (source->pointsTimes.size() >= sampleCount && attribute.times() == source->points.times())
                source->rates.push_back({attribute, sampleCount});
            else
                source->blocked.emplace_back(name, TfToken("vector3f[]"));
        }
        sampleCount++;
    }
}

std::vector<Patch> readPatches(Composition &composition, const Found &found, const Topology &topology, const Params &params,
                               std::vector<std::string> *problems) {
    std::vector<Patch> patches;
    for (const std::string &name : found.patches) {
        try {
            patches.emplace_back(composition, found.prim, name, topology, params);
        } catch (const Fault &bad) {
            problems->push_back(TfStringPrintf("%s: patch %s: %s", found.prim.path().GetText(), name.c_str(), bad.what()));
        }
    }
    return patches;
}

// Throws Fault, or adds problems and returns null.
std::shared_ptr<const PatchedMesh> readSource(Composition &composition, const Found &found, const Params &params,
                                              std::vector<std::string> *problems) {
    auto source = std::make_shared<PatchedMesh>();
    const Prim &prim = found.prim;
    source->path = prim.path();
    source->points = prim.attribute(names().points);
    VtVec3fArray first = firstPoints(composition, prim, source->points);
    source->topology = readTopology(prim, first.size());
    source->rest = readRest(prim, source->points, first.size());
    source->patches = readPatches(composition, found, source->topology, params, problems);
    if (source->patches.size() != found.patches.size())
        return nullptr;
    if (std::any_of(source->patches.begin(), source->patches.end(),
                    [](const Patch &patch) { return patch.needsSubdivision(); }))
        source->subdivision = Subdivision(prim);
    source->pointsTimes = mergedTimes(source->points.times());
    // Points first: where times differ by noise, theirs gives a sample as it was authored.
    std::vector<double> times = source->pointsTimes;
    for (const Patch &patch : source->patches) {
        std::vector<double> more = patch.times();
        times.insert(times.end(), more.begin(), more.end());
    }
    source->times = mergedTimes(times);
    source->timeCodesPerSecond = composition.root()->GetTimeCodesPerSecond();
    VtValue orientation = prim.attribute(names().orientation).at(Attribute::defaultTime);
    source->leftHanded = orientation.IsHolding<TfToken>() && orientation.UncheckedGet<TfToken>() == names().leftHanded;
    readNormals(prim, source.get());
    readRates(prim, source.get());
    return source;
}

} // namespace

std::vector<std::shared_ptr<const PatchedMesh>> readMeshes(Composition &composition, const Params &params,
                                                           std::vector<std::string> *problems) {
    std::vector<std::shared_ptr<const PatchedMesh>> sources;
    Search search(composition);
    auto say = [&](const Found &found, const std::string &message) {
        problems->push_back(found.prim.path().GetString() + ": " + message);
    };
    for (const Found &found : search.found()) {
        std::string other = slidBy(found.prim.attribute(names().points));
        if (!found.whyNot.empty()) {
            say(found, found.whyNot);
        } else if (!other.empty()) {
            // Without opinions of its own on the mesh a file just passes on what the other computes.
            if (composition.root()->GetPrimAtPath(found.prim.path()))
                say(found, "is slid already, by " + other + "; set it up there, or reference the cache itself");
        } else {
            try {
                if (std::shared_ptr<const PatchedMesh> source = readSource(composition, found, params, problems))
                    sources.push_back(source);
            } catch (const Fault &bad) {
                say(found, bad.what());
            }
        }
    }
    if (search.found().empty())
        problems->push_back("nothing to slide: no mesh has SkinSlideAPI applied");
    return sources;
}

} // namespace skinslide
