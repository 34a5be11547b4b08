// The file format of .skinslide files: a USDA layer with the points of its slid meshes as opinions of its own.
#ifndef SKINSLIDE_FORMAT_FILE_FORMAT_H
#define SKINSLIDE_FORMAT_FILE_FORMAT_H

#include "pxr/pxr.h"

#include "pxr/usd/pcp/dynamicFileFormatInterface.h"
#include "pxr/usd/sdf/fileFormat.h"

PXR_NAMESPACE_OPEN_SCOPE

class SkinSlideFileFormat : public SdfFileFormat, public PcpDynamicFileFormatInterface {
  public:
    // Reads the text, composes it, and finds what can be slid. Computes no frame.
    bool CanRead(const std::string &file) const override;
    bool Read(SdfLayer *layer, const std::string &resolvedPath, bool metadataOnly) const override;
    // As USDA, with every frame.
    bool WriteToString(const SdfLayer &layer, std::string *text, const std::string &comment = std::string()) const override;
    bool WriteToStream(const SdfSpecHandle &spec, std::ostream &out, size_t indent) const override;
    std::set<std::string> GetExternalAssetDependencies(const SdfLayer &layer) const override;

    void ComposeFieldsForFileFormatArguments(const std::string &assetPath, const PcpDynamicFileFormatContext &context,
                                             FileFormatArguments *arguments, VtValue *dependencyData) const override;
    bool CanAttributeDefaultValueChangeAffectFileFormatArguments(const TfToken &name, const VtValue &oldValue,
                                                                 const VtValue &newValue,
                                                                 const VtValue &dependencyData) const override;

  private:
    SDF_FILE_FORMAT_FACTORY_ACCESS;
    SkinSlideFileFormat();
    void readText(SdfLayer *layer, const std::string &resolvedPath, double timeCodesPerSecond) const;
    bool compose(SdfLayer *layer, const std::string &resolvedPath, bool metadataOnly) const;
};

PXR_NAMESPACE_CLOSE_SCOPE

#endif
