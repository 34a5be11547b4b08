// The content of an open .skinslide layer: its text, and attributes whose values are computed when they are asked for.
#ifndef SKINSLIDE_FORMAT_DATA_H
#define SKINSLIDE_FORMAT_DATA_H

#include "liveMesh.h"

#include "pxr/usd/sdf/data.h"

#include <functional>
#include <set>
#include <string>
#include <unordered_map>

namespace skinslide {

TF_DECLARE_WEAK_AND_REF_PTRS(Data);

class Data : public SdfData {
  public:
    // A copy of the content of a text, in which the computed attributes are declared.
    static DataRefPtr create(const SdfAbstractDataConstPtr &text, const std::vector<std::shared_ptr<LiveMesh>> &meshes);

    // Resolved paths of every file that the values depend on.
    std::set<std::string> dependencies;
    // Layers that are kept open: sources, so that a reload finds them; nested .skinslide files, since every layer that leads to
    // one through others would read it again, twice as often with each.
    std::vector<SdfLayerRefPtr> sources, nested;

    bool StreamsData() const override;
    bool IsDetached() const override;
    bool Has(const SdfPath &path, const TfToken &field, SdfAbstractDataValue *value) const override;
    bool Has(const SdfPath &path, const TfToken &field, VtValue *value = nullptr) const override;
    bool HasSpecAndField(const SdfPath &path, const TfToken &field, SdfAbstractDataValue *value,
                         SdfSpecType *type) const override;
    bool HasSpecAndField(const SdfPath &path, const TfToken &field, VtValue *value, SdfSpecType *type) const override;
    VtValue Get(const SdfPath &path, const TfToken &field) const override;
    const std::type_info &GetTypeid(const SdfPath &path, const TfToken &field) const override;
    std::vector<TfToken> List(const SdfPath &path) const override;
    std::set<double> ListAllTimeSamples() const override;
    std::set<double> ListTimeSamplesForPath(const SdfPath &path) const override;
    bool GetBracketingTimeSamples(double time, double *lower, double *upper) const override;
    size_t GetNumTimeSamplesForPath(const SdfPath &path) const override;
    bool GetBracketingTimeSamplesForPath(const SdfPath &path, double time, double *lower, double *upper) const override;
    bool QueryTimeSample(const SdfPath &path, double time, SdfAbstractDataValue *value) const override;
    bool QueryTimeSample(const SdfPath &path, double time, VtValue *value) const override;
#if PXR_VERSION >= 2505 // earlier USD asks for the samples and the value instead
    bool GetPreviousTimeSampleForPath(const SdfPath &path, double time, double *previous) const override;
    const std::type_info &QueryTimeSampleTypeid(const SdfPath &path, double time) const override;
#endif

  private:
    using Compute = std::function<VtValue(double time)>;
    struct Computed {
        std::vector<double> times; // ascending; none: a default
        Compute at;
        VtValue standard; // of the declared type
    };
    const Computed *computed(const SdfPath &path) const;
    // The computed attribute that has this field, or null.
    const Computed *computedField(const SdfPath &path, const TfToken &field) const;
    static VtValue valueAt(const Computed &attribute, double time);
    static VtValue fieldValue(const Computed &attribute);
    static bool hasSample(const Computed &attribute, double time);

    void addMesh(const std::shared_ptr<LiveMesh> &live);
    void add(const SdfPath &prim, const TfToken &name, const TfToken &type, const std::vector<double> &times, Compute at);

    std::unordered_map<SdfPath, Computed, SdfPath::Hash> _computed;
};

} // namespace skinslide

#endif
