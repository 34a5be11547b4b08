#include "meshes.h"

#include "names.h"
#include "space.h"

#include <algorithm>
#include <map>

namespace skinslide {

bool PatchedMesh::carries() const {
    return std::any_of(derived.begin(), derived.end(), [](const Derived &own) { return own.output->is_carried; });
}

bool PatchedMesh::controlsVary() const {
    return std::any_of(patches.begin(), patches.end(), [](const Patch &patch) { return patch.varies(); });
}

namespace {

using Finding = Handle<skinslide_stage_finding, skinslide_stage_finding_destroy>;

// ---- Finding meshes ----

// What mentions the schema, and the roots of prototypes, each with its point instancer.
struct Found {
    std::vector<Prim> prims;
    std::map<SdfPath, SdfPath> prototypes;
};

bool mentionsSchema(const std::string &name) {
    return TfStringStartsWith(name, skinslide_stage_schema());
}

// Names of properties are not looked at: those that count for nothing keep no mesh from being slid, and check names them.
Found search(Composition &composition) {
    Found found;
    composition.traverse([&](const Prim &prim) {
        if (!prim.active() || prim.specifier() == SdfSpecifierClass)
            return false;
        if (prim.typeName() == names().pointInstancer) {
            for (const SdfPath &target : composition.targets(prim.path().AppendProperty(names().prototypes)))
                found.prototypes[target] = prim.path();
        }
        std::vector<std::string> schemas = prim.apiSchemas();
        if (std::any_of(schemas.begin(), schemas.end(), mentionsSchema))
            found.prims.push_back(prim);
        return true;
    });
    return found;
}

// What a prim is below: undefined prims, the outermost instance, a prototype of a point instancer; the nearest SkelRoot, and
// the Skeleton that is bound there or below.
struct Place {
    bool defined = true;
    std::string instance, instancer, skelRoot, skeleton;
};

bool has(const TfTokenVector &names, const TfToken &name) {
    return std::find(names.begin(), names.end(), name) != names.end();
}

SdfPathVector targets(Composition &composition, const Prim &prim, const TfToken &name) {
    return has(prim.propertyNames(), name) ? composition.targets(prim.path().AppendProperty(name)) : SdfPathVector();
}

// Of a binding that holds below a prim; empty where it unbinds what is bound above.
std::string boundBy(Composition &composition, const Prim &prim) {
    SdfPathVector bound = targets(composition, prim, names().boundSkeleton);
    bool isSkeleton = !bound.empty() && composition.prim(bound[0].GetPrimPath()).typeName() == names().skeleton;
    return isSkeleton ? bound[0].GetString() : "";
}

Place placeOf(Composition &composition, const Found &found, const SdfPath &path) {
    Place place;
    for (const SdfPath &prefix : path.GetPrefixes()) {
        Prim prim = composition.prim(prefix);
        auto prototype = found.prototypes.find(prefix);
        place.defined = place.defined && prim.specifier() == SdfSpecifierDef;
        if (place.instance.empty() && prefix != path && prim.instanceable())
            place.instance = prefix.GetString();
        if (place.instancer.empty() && prototype != found.prototypes.end())
            place.instancer = prototype->second.GetString();
        if (prim.typeName() == names().skelRoot)
            place.skelRoot = prefix.GetString(), place.skeleton.clear();
        if (has(prim.propertyNames(), names().boundSkeleton))
            place.skeleton = boundBy(composition, prim);
    }
    return place;
}

// The layer whose computed points these are, where another .skinslide file slides the mesh already.
std::string slidBy(const Attribute &points) {
    const SdfLayerRefPtr &layer = points.layer();
    if (!layer || layer->GetFileFormat()->GetFormatId() != TfToken("skinslide"))
        return "";
    return Params::fromArguments(layer->GetFileFormatArguments(), nullptr).computes ? layer->GetIdentifier() : "";
}

std::string bakedBy(const Composition &composition, const Attribute &points) {
    SdfLayerRefPtr layer = points.bakedLayer();
    return !layer                        ? ""
           : layer == composition.root() ? composition.root()->GetResolvedPath().GetPathString()
                                         : layer->GetIdentifier();
}

bool isAuthored(Composition &composition, const Prim &prim, const TfToken &primvar) {
    return ownerOf(composition, prim, primvar).attribute(primvar).authored();
}

Finding find(Composition &composition, const Found &found, const Prim &prim, const std::string &other) {
    Attribute points = prim.attribute(names().points);
    TfToken type = prim.typeName();
    Place place = placeOf(composition, found, prim.path());
    std::string bake = bakedBy(composition, points);
    std::vector<std::string> applied = prim.apiSchemas();
    std::vector<const char *> schemas;
    for (const std::string &schema : applied)
        schemas.push_back(schema.c_str());
    auto orNull = [](const std::string &text) { return text.empty() ? nullptr : text.c_str(); };
    skinslide_stage_prim facts = SKINSLIDE_STAGE_PRIM_DEFAULT;
    facts.type_name = type.GetText(), facts.is_mesh = type == names().mesh, facts.is_defined = place.defined;
    facts.instance = orNull(place.instance), facts.instancer = orNull(place.instancer);
    facts.slid_by = orNull(other), facts.baked_by = orNull(bake);
    facts.point_samples = points.source() == Attribute::Source::Samples || points.clipped();
    facts.has_joint_indices = isAuthored(composition, prim, names().jointIndices);
    facts.has_joint_weights = isAuthored(composition, prim, names().jointWeights);
    facts.blend_shape_count = static_cast<int32_t>(targets(composition, prim, names().blendShapes).size());
    facts.skel_root = orNull(place.skelRoot), facts.skeleton = orNull(place.skeleton);
    facts.variant_set = orNull(points.variant().first), facts.variant = orNull(points.variant().second);
    facts.schema_count = static_cast<int32_t>(schemas.size()), facts.schemas = schemas.data();
    return make<Finding>(skinslide_stage_find, &facts);
}

void addProblems(const SdfPath &prim, const skinslide_stage_finding &finding, std::vector<std::string> *problems) {
    for (int32_t i = 0; i < finding.problem_count; i++) {
        const skinslide_stage_problem *problem = finding.problems[i];
        std::string where = prim == SdfPath::AbsoluteRootPath() ? "" : prim.GetString() + ": ";
        if (problem->patch)
            where += std::string("patch ") + problem->patch + ": ";
        problems->push_back(where + problem->message);
    }
}

void addUncomposed(const Composition &composition, std::vector<std::string> *problems) {
    for (const auto &[prim, message] : composition.errors()) {
        std::string line = TfStringJoin(TfStringTokenize(message), " ");
        skinslide_stage_prim facts = SKINSLIDE_STAGE_PRIM_DEFAULT;
        facts.uncomposed = line.c_str();
        addProblems(prim, *make<Finding>(skinslide_stage_find, &facts), problems);
    }
}

// ---- Reading one mesh ----

void readGroup(Composition &composition, const Prim &prim, skinslide_stage_group group, skinslide_stage_mesh *mesh) {
    for (const Property &property : properties(composition, prim, group))
        property.give(mesh, skinslide_stage_mesh_take, skinslide_stage_mesh_check);
}

std::vector<Patch> readPatches(Composition &composition, const Prim &prim, const skinslide_stage_finding &finding,
                               const skinslide_stage_mesh *mesh, const Params &params, std::vector<std::string> *problems) {
    std::vector<Patch> patches;
    for (int32_t i = 0; i < finding.patch_count; i++) {
        try {
            patches.emplace_back(composition, prim, mesh, finding.patches[i], params.live);
        } catch (const Fault &bad) {
            problems->push_back(TfStringPrintf("%s: patch %s: %s", prim.path().GetText(), finding.patches[i], bad.what()));
        }
    }
    return patches;
}

// Its own primvars, of which errors list those that may be texture coordinates.
void offerPrimvars(const Prim &prim, skinslide_stage_mesh *mesh) {
    TfTokenVector properties = prim.propertyNames();
    std::sort(properties.begin(), properties.end());
    for (const TfToken &name : properties) {
        Attribute attribute = prim.attribute(name);
        if (TfStringStartsWith(name.GetString(), "primvars:") && attribute.authored())
            call(skinslide_stage_mesh_offer, mesh, name.GetText(), attribute.typeName().GetText(),
                 attribute.token(names().interpolation, names().constant).GetText());
    }
}

// How the transforms above a mesh scale it, at each time at which they were authored.
void takeSpace(Composition &composition, const SdfPath &path, skinslide_stage_mesh *mesh) {
    ToWorld way(composition, path);
    call(skinslide_stage_mesh_space, mesh, way.at(Attribute::first).data(), 0.0);
    for (double time : way.times())
        call(skinslide_stage_mesh_space, mesh, way.at(time).data(), time);
}

// ---- Meshes beside it ----

// Points of a mesh at the first time, as floats; none where it has none.
VtVec3fArray pointsOf(const Prim &prim) {
    Record record(prim.attribute(names().points), Attribute::first);
    VtVec3fArray points(static_cast<size_t>(skinslide_value_length(record)));
    return skinslide_value_positions(record, floatsOf(&points), nullptr) == SKINSLIDE_OK ? points : VtVec3fArray();
}

// Meshes in the space of another, as a stage is traversed: without what is inside instances.
std::vector<Prim> beside(Composition &composition, const Prim &prim) {
    std::vector<Prim> found;
    GfMatrix4d own = ToWorld(composition, prim.path()).at(Attribute::first);
    composition.traverse([&](const Prim &other) {
        if (!other.active() || other.specifier() != SdfSpecifierDef)
            return false;
        if (other.typeName() == names().mesh && other.path() != prim.path() &&
            ToWorld(composition, other.path()).at(Attribute::first) == own)
            found.push_back(other);
        return !other.instanceable();
    });
    return found;
}

void meetNeighbours(Composition &composition, const Found &found, const Prim &prim, PatchedMesh *mesh,
                    std::vector<std::string> *problems) {
    if (std::none_of(mesh->patches.begin(), mesh->patches.end(), [](const Patch &patch) { return patch.wantsNeighbours(); }))
        return;
    for (const Prim &other : beside(composition, prim)) {
        VtVec3fArray points = pointsOf(other);
        if (points.empty())
            continue;
        if (find(composition, found, other, "")->skinned_by) {
            problems->push_back(TfStringPrintf("%s: whether borders meet %s is not known here, since UsdSkel skins it; "
                                               "sublayer its points, which skinslide cache "
                                               "writes",
                                               prim.path().GetText(), other.path().GetText()));
            continue;
        }
        for (Patch &patch : mesh->patches) {
            if (patch.wantsNeighbours())
                patch.meet(points);
        }
    }
}

void merge(std::vector<double> *times) {
    int64_t count = static_cast<int64_t>(times->size());
    call(skinslide_stage_merge_times, times->data(), &count);
    times->resize(static_cast<size_t>(count));
}

// As the core merges them, the samples of points first: where times differ by noise, theirs gives a sample as it was authored.
// With the frames between.
std::vector<double> timesOf(const PatchedMesh &mesh) {
    std::vector<double> times = mesh.points.attribute().times();
    for (const Patch &patch : mesh.patches) {
        std::vector<double> more = patch.times();
        times.insert(times.end(), more.begin(), more.end());
    }
    merge(&times);
    int64_t count = static_cast<int64_t>(times.size()), more = 0;
    call(skinslide_stage_times_between, times.data(), count, nullptr, &more);
    times.resize(static_cast<size_t>(count + more));
    call(skinslide_stage_times_between, times.data(), count, times.data() + count, &more);
    merge(&times);
    return times;
}

// The primvars that follow from points too.
void addOffered(Composition &composition, const Prim &prim, skinslide_stage_derived *derived, std::vector<Property> *cached) {
    TfTokenVector properties = prim.propertyNames();
    std::sort(properties.begin(), properties.end());
    for (const TfToken &name : properties) {
        Attribute attribute = prim.attribute(name);
        if (!attribute.authored() && !attribute.clipped())
            continue;
        VtValue size = attribute.metadata(names().elementSize);
        const skinslide_stage_input *input = nullptr;
        call(skinslide_stage_derived_offer, derived, name.GetText(), attribute.typeName().GetText(),
             attribute.token(names().interpolation, names().constant).GetText(), size.IsHolding<int>() ? size.Get<int>() : 1,
             &input);
        if (input)
            cached->emplace_back(composition, prim, input);
    }
}

void readDerived(Composition &composition, const Prim &prim, PatchedMesh *mesh, std::vector<std::string> *problems) {
    std::vector<double> pointTimes = mesh->points.attribute().times();
    mesh->derivation =
        make<DerivedHandle>(skinslide_stage_derived_create, mesh->mesh.get(), pointTimes.data(),
                            static_cast<int64_t>(pointTimes.size()), composition.root()->GetTimeCodesPerSecond());
    skinslide_stage_derived *derived = mesh->derivation.get();
    call(skinslide_stage_derived_fill, derived);
    std::vector<Property> cached = properties(composition, prim, SKINSLIDE_STAGE_DERIVED);
    addOffered(composition, prim, derived, &cached);
    for (const Property &property : cached) {
        std::vector<double> times = property.samples();
        call(skinslide_stage_derived_take, derived, property.input(), property.first(), times.data(),
             static_cast<int64_t>(times.size()));
    }
    for (const Property &property : cached) {
        for (double time : property.samples())
            call(skinslide_stage_derived_check, derived, property.input(), property.at(time));
    }
    for (int32_t i = 0; const char *warning = skinslide_stage_derived_warning(derived, i); i++)
        problems->push_back(mesh->path.GetString() + ": " + warning);
    for (int32_t i = 0; const skinslide_stage_output *output = skinslide_stage_derived_output(derived, i); i++) {
        auto own = std::find_if(cached.begin(), cached.end(),
                                [&](const Property &property) { return property.attribute().name() == output->name; });
        mesh->derived.push_back({output, own == cached.end() ? Property() : *own});
        if (output->reason)
            problems->push_back(TfStringPrintf("%s: %s cannot be recomputed, so they are blocked: %s", mesh->path.GetText(),
                                               output->name, output->reason));
    }
}

void addWarnings(const PatchedMesh &mesh, std::vector<std::string> *problems) {
    for (const char *warning :
         {skinslide_stage_mesh_rest_warning(mesh.mesh.get()), skinslide_stage_mesh_warning(mesh.mesh.get()),
          skinslide_stage_mesh_space_warning(mesh.mesh.get())}) {
        if (warning)
            problems->push_back(mesh.path.GetString() + ": " + warning);
    }
    for (const Patch &patch : mesh.patches) {
        if (const char *warning = patch.warning())
            problems->push_back(mesh.path.GetString() + ": patch " + patch.name() + ": " + warning);
    }
}

// Throws Fault, or adds problems and returns null.
std::shared_ptr<const PatchedMesh> readMesh(Composition &composition, const Found &found, const Prim &prim,
                                            const skinslide_stage_finding &finding, const Params &params,
                                            std::vector<std::string> *problems) {
    auto mesh = std::make_shared<PatchedMesh>();
    mesh->path = prim.path();
    mesh->points = Property(composition, prim, skinslide_stage_next_input(SKINSLIDE_STAGE_MESH, nullptr));
    mesh->mesh = make<MeshHandle>(skinslide_stage_mesh_create);
    readGroup(composition, prim, SKINSLIDE_STAGE_MESH, mesh->mesh.get());
    offerPrimvars(prim, mesh->mesh.get());
    takeSpace(composition, prim.path(), mesh->mesh.get());
    mesh->patches = readPatches(composition, prim, finding, mesh->mesh.get(), params, problems);
    if (mesh->patches.size() != static_cast<size_t>(finding.patch_count))
        return nullptr;
    meetNeighbours(composition, found, prim, mesh.get(), problems);
    if (std::any_of(mesh->patches.begin(), mesh->patches.end(), [](const Patch &patch) { return patch.needsSubdivision(); }))
        readGroup(composition, prim, SKINSLIDE_STAGE_SUBDIVISION, mesh->mesh.get());
    mesh->times = timesOf(*mesh);
    addWarnings(*mesh, problems);
    readDerived(composition, prim, mesh.get(), problems);
    return mesh;
}

} // namespace

std::vector<std::shared_ptr<const PatchedMesh>> readMeshes(Composition &composition, const Params &params,
                                                           std::vector<std::string> *problems) {
    std::vector<std::shared_ptr<const PatchedMesh>> meshes;
    Found found = search(composition);
    bool any = false;
    for (const Prim &prim : found.prims) {
        std::string other = slidBy(prim.attribute(names().points));
        Finding finding = find(composition, found, prim, other);
        any = any || finding->patch_count || finding->problem_count;
        // Without opinions of its own on the mesh a file just passes on what another computes.
        if (!other.empty() && !composition.root()->GetPrimAtPath(prim.path()))
            continue;
        addProblems(prim.path(), *finding, problems);
        try {
            if (!finding->slides)
                continue;
            if (std::shared_ptr<const PatchedMesh> mesh = readMesh(composition, found, prim, *finding, params, problems))
                meshes.push_back(mesh);
        } catch (const Fault &bad) {
            problems->push_back(prim.path().GetString() + ": " + bad.what());
        }
    }
    skinslide_error error;
    if (!any && skinslide_stage_nothing(nullptr, &error))
        problems->push_back(error.message);
    addUncomposed(composition, problems);
    return meshes;
}

} // namespace skinslide
