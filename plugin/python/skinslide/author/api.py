"""The schemas of skinslide, as classes like pxr's. Made by schema/methods.py from schema/schema.usda."""

from __future__ import annotations

import os
from typing import Literal

import numpy.typing as npt
from pxr import Sdf, Usd, UsdGeom

from skinslide.author.applied import AppliedPatch, AppliedSchema


class SkinSlideAPI(AppliedPatch):
    """Lets the skin of a mesh slide, so that its texture keeps its rest spacing.

    It may be that of a whole character with nothing painted, or a patch that somebody chose.

    A character needs nothing painted: skinslide setup --whole applies this once to each mesh, as SkinSlideAPI:skin,
    to the faces whose edges ever stretch and those around them, with the rule even. The instance name is the patch's
    name: SkinSlideAPI:elbow_L. A mesh may carry many patches, and patches may overlap.

    What is painted on patch NAME is in primvars, which the schema of a patch cannot declare:
    - primvars:skinSlide:NAME:patch: the faces. bool[], int[] or numbers; uniform: faces of value above 0; vertex:
      faces whose points are all above 0. Where it is absent, the GeomSubset child called NAME (elementType face)
      gives them. Faces that fall into several pieces are several patches with the same settings.
    - primvars:skinSlide:NAME:weight: how far each point slides, 0 to 1. float, vertex or constant; may be animated.
      Absent: 1. With interpolation limit it scales the slide of limit points: a point of weight 0 still follows its
      neighbours so that its limit point stays.
    - primvars:skinSlide:NAME:maxDistance: how far each point may slide along the surface, in the mesh's units.
      float, 0 or more, vertex or constant; may be animated. Absent: no limit.
    - primvars:skinSlide:NAME:forceDensity: how hard edges pull. float above 0; vertex (an edge takes the mean of its
      ends), uniform (the mean of its faces) or constant; may be animated. Only ratios matter. Absent: 1.
    - primvars:skinSlide:NAME:hold: how closely each point follows the slide of its neighbours, under the rules
      relaxed and even: low where surplus skin is to come from, high where it must not. float above 0, vertex or
      constant; far under 0.1 nothing keeps skin from sliding at random; may be animated. Absent: 1.

    Numbers are half, float or double; of pairs and colours, the one that paintChannel names counts. Of faceVarying
    paint, the mean over the face corners at each point counts. For tools that know no namespaces, paint may also be
    named primvars:skinSlide_NAME_weight, with underscores for all colons but the first. check says what it took.

    A bake with --diagnostics writes what it did to the skin beside the points. By vertex, float:
    primvars:skinSlide:stretch, the RMS of log(length / rest length) over the edges of patches at the point;
    primvars:skinSlide:slide, how far it slid, in the mesh's units; primvars:skinSlide:largestStretch and
    primvars:skinSlide:smallestStretch, the principal stretches as lengths over lengths at rest, and
    primvars:skinSlide:areaRatio, their product. By corner, float2, on meshes with primvars:st:
    primvars:skinSlide:stretchDirection, that of the largest in st, as the cosine and sine of twice its angle from s
    towards t, so that values blend. skinslide reads none of them.

    The rest pose, in which nothing slides, belongs to the mesh. It is the first found of skinSlide:restPoints
    (point3f[]), primvars:rest, primvars:pref, primvars:Pref, primvars:__Pref and the default value of points.
    """

    SCHEMA = "SkinSlideAPI"
    NAMESPACE = "skinSlide"
    APPLIES_TO = ("Mesh",)

    def GetEnvelopeAttr(self) -> Usd.Attribute:
        """Scales the slide of the whole patch: 0 leaves the cache as it is, 1 slides fully.

        Values outside 0 to 1 are clamped.

        Returns:
            The attribute skinSlide:NAME:envelope, float; invalid if there is none.
        """
        return self._attribute("envelope")

    def CreateEnvelopeAttr(self, defaultValue: float | None = None, writeSparsely: bool = False) -> Usd.Attribute:
        """Authors skinSlide:NAME:envelope in the edit target.

        Args:
            defaultValue: Its default value, float; None: none is authored.
            writeSparsely: Authors nothing if that is the fallback, and no other value is authored.

        Returns:
            The attribute.

        Raises:
            UsageError: The value is of another type.
        """
        return self._create_attribute("envelope", defaultValue, writeSparsely)

    def GetCornersAttr(self) -> Usd.Attribute:
        """Four point indices on the outer boundary of the patch, in any order.

        They go to the corners of the square in which the patch is laid out. Absent: none.

        Returns:
            The attribute skinSlide:NAME:corners, int[], uniform; invalid if there is none.
        """
        return self._attribute("corners")

    def CreateCornersAttr(
        self, defaultValue: npt.ArrayLike | None = None, writeSparsely: bool = False
    ) -> Usd.Attribute:
        """Authors skinSlide:NAME:corners in the edit target.

        Args:
            defaultValue: Its default value, int[], uniform; None: none is authored.
            writeSparsely: Authors nothing if that is the fallback, and no other value is authored.

        Returns:
            The attribute.

        Raises:
            UsageError: The value is of another type.
        """
        return self._create_attribute("corners", defaultValue, writeSparsely)

    def GetBoundaryAttr(self) -> Usd.Attribute:
        """The outline in which the patch is laid out.

        auto: the square where corners are given, else the circle. square without corners: the sharpest point of the
        boundary goes to a corner, and so do those nearest to each quarter of the way round from it.

        Returns:
            The attribute skinSlide:NAME:boundary, token, uniform; invalid if there is none.
        """
        return self._attribute("boundary")

    def CreateBoundaryAttr(
        self, defaultValue: Literal["auto", "square", "circle"] | None = None, writeSparsely: bool = False
    ) -> Usd.Attribute:
        """Authors skinSlide:NAME:boundary in the edit target.

        Args:
            defaultValue: Its default value, token, uniform; None: none is authored.
            writeSparsely: Authors nothing if that is the fallback, and no other value is authored.

        Returns:
            The attribute.

        Raises:
            UsageError: The value is of another type.
        """
        return self._create_attribute("boundary", defaultValue, writeSparsely)

    def GetHolesAttr(self) -> Usd.Attribute:
        """What happens at the rims of holes in the patch, such as eyes, nostrils and mouth.

        pinned: rims stay on the cached points. free: rims slide too, and faces near them may fold, which is counted.
        freeAll: the outer boundary slides along itself too, under the rules relaxed and even. Border points in which
        pieces of the patch touch stay.

        Returns:
            The attribute skinSlide:NAME:holes, token, uniform; invalid if there is none.
        """
        return self._attribute("holes")

    def CreateHolesAttr(
        self, defaultValue: Literal["pinned", "free", "freeAll"] | None = None, writeSparsely: bool = False
    ) -> Usd.Attribute:
        """Authors skinSlide:NAME:holes in the edit target.

        Args:
            defaultValue: Its default value, token, uniform; None: none is authored.
            writeSparsely: Authors nothing if that is the fallback, and no other value is authored.

        Returns:
            The attribute.

        Raises:
            UsageError: The value is of another type.
        """
        return self._create_attribute("holes", defaultValue, writeSparsely)

    def GetForceDensityRuleAttr(self) -> Usd.Attribute:
        """Where skin slides to.

        unit and fast balance the pull of edges in a flat layout of the patch; an edge of length l pulls with 1/l, or
        with the largest l*l of the patch less l*l. relaxed and even slide on the rest surface itself, and take a
        patch of any shape, open or closed, as large as a whole character. even: to where stretch is balanced,
        smoothly over time. relaxed: to where every edge is as near its rest length as the deformed surface allows.
        Under both, force density says how much an edge counts, and corners and boundary are not read.

        Returns:
            The attribute skinSlide:NAME:forceDensityRule, token, uniform; invalid if there is none.
        """
        return self._attribute("forceDensityRule")

    def CreateForceDensityRuleAttr(
        self, defaultValue: Literal["unit", "fast", "relaxed", "even"] | None = None, writeSparsely: bool = False
    ) -> Usd.Attribute:
        """Authors skinSlide:NAME:forceDensityRule in the edit target.

        Args:
            defaultValue: Its default value, token, uniform; None: none is authored.
            writeSparsely: Authors nothing if that is the fallback, and no other value is authored.

        Returns:
            The attribute.

        Raises:
            UsageError: The value is of another type.
        """
        return self._create_attribute("forceDensityRule", defaultValue, writeSparsely)

    def GetGrowAttr(self) -> Usd.Attribute:
        """How far the patch grows around the chosen faces, under the rules relaxed and even.

        Faces join it of which every point is within this distance along the rest surface, in the mesh's units. A
        wider patch has more skin to give than one that is pinned close by.

        Returns:
            The attribute skinSlide:NAME:grow, float, uniform; invalid if there is none.
        """
        return self._attribute("grow")

    def CreateGrowAttr(self, defaultValue: float | None = None, writeSparsely: bool = False) -> Usd.Attribute:
        """Authors skinSlide:NAME:grow in the edit target.

        Args:
            defaultValue: Its default value, float, uniform; None: none is authored.
            writeSparsely: Authors nothing if that is the fallback, and no other value is authored.

        Returns:
            The attribute.

        Raises:
            UsageError: The value is of another type.
        """
        return self._create_attribute("grow", defaultValue, writeSparsely)

    def GetStretchResponseAttr(self) -> Usd.Attribute:
        """How much of the stretch the rules relaxed and even take out, 0 to 1.

        Returns:
            The attribute skinSlide:NAME:stretchResponse, float; invalid if there is none.
        """
        return self._attribute("stretchResponse")

    def CreateStretchResponseAttr(
        self, defaultValue: float | None = None, writeSparsely: bool = False
    ) -> Usd.Attribute:
        """Authors skinSlide:NAME:stretchResponse in the edit target.

        Args:
            defaultValue: Its default value, float; None: none is authored.
            writeSparsely: Authors nothing if that is the fallback, and no other value is authored.

        Returns:
            The attribute.

        Raises:
            UsageError: The value is of another type.
        """
        return self._create_attribute("stretchResponse", defaultValue, writeSparsely)

    def GetCompressionResponseAttr(self) -> Usd.Attribute:
        """How much of the compression the rules relaxed and even take out, 0 to 1.

        Returns:
            The attribute skinSlide:NAME:compressionResponse, float; invalid if there is none.
        """
        return self._attribute("compressionResponse")

    def CreateCompressionResponseAttr(
        self, defaultValue: float | None = None, writeSparsely: bool = False
    ) -> Usd.Attribute:
        """Authors skinSlide:NAME:compressionResponse in the edit target.

        Args:
            defaultValue: Its default value, float; None: none is authored.
            writeSparsely: Authors nothing if that is the fallback, and no other value is authored.

        Returns:
            The attribute.

        Raises:
            UsageError: The value is of another type.
        """
        return self._create_attribute("compressionResponse", defaultValue, writeSparsely)

    def GetInterpolationAttr(self) -> Usd.Attribute:
        """How a place within a face becomes a point on the deformed surface.

        linear: in the triangles that share the face's first point. meanValue: by mean value coordinates in the
        polygon. limit: on the subdivision limit surface. auto: limit where the mesh renders as a subdivision
        surface, else linear.

        Returns:
            The attribute skinSlide:NAME:interpolation, token, uniform; invalid if there is none.
        """
        return self._attribute("interpolation")

    def CreateInterpolationAttr(
        self, defaultValue: Literal["auto", "linear", "meanValue", "limit"] | None = None, writeSparsely: bool = False
    ) -> Usd.Attribute:
        """Authors skinSlide:NAME:interpolation in the edit target.

        Args:
            defaultValue: Its default value, token, uniform; None: none is authored.
            writeSparsely: Authors nothing if that is the fallback, and no other value is authored.

        Returns:
            The attribute.

        Raises:
            UsageError: The value is of another type.
        """
        return self._create_attribute("interpolation", defaultValue, writeSparsely)

    def GetEdgesAttr(self) -> Usd.Attribute:
        """Pairs of point indices, each an edge of the patch whose force density edgeForceDensities scales.

        Absent: none.

        Returns:
            The attribute skinSlide:NAME:edges, int[], uniform; invalid if there is none.
        """
        return self._attribute("edges")

    def CreateEdgesAttr(self, defaultValue: npt.ArrayLike | None = None, writeSparsely: bool = False) -> Usd.Attribute:
        """Authors skinSlide:NAME:edges in the edit target.

        Args:
            defaultValue: Its default value, int[], uniform; None: none is authored.
            writeSparsely: Authors nothing if that is the fallback, and no other value is authored.

        Returns:
            The attribute.

        Raises:
            UsageError: The value is of another type.
        """
        return self._create_attribute("edges", defaultValue, writeSparsely)

    def GetEdgeForceDensitiesAttr(self) -> Usd.Attribute:
        """One factor above 0 for each pair in edges; it multiplies the painted force density.

        Only ratios matter. Absent: none.

        Returns:
            The attribute skinSlide:NAME:edgeForceDensities, float[]; invalid if there is none.
        """
        return self._attribute("edgeForceDensities")

    def CreateEdgeForceDensitiesAttr(
        self, defaultValue: npt.ArrayLike | None = None, writeSparsely: bool = False
    ) -> Usd.Attribute:
        """Authors skinSlide:NAME:edgeForceDensities in the edit target.

        Args:
            defaultValue: Its default value, float[]; None: none is authored.
            writeSparsely: Authors nothing if that is the fallback, and no other value is authored.

        Returns:
            The attribute.

        Raises:
            UsageError: The value is of another type.
        """
        return self._create_attribute("edgeForceDensities", defaultValue, writeSparsely)

    def GetForceDensityMapAttr(self) -> Usd.Attribute:
        """An OpenEXR image, one file or a UDIM (body.<UDIM>.exr).

        Its values multiply the painted force density by point. Sampled bilinearly at mapSt; a point takes the mean
        over its corners in the patch. Values must be above 0. May be animated. Absent: none.

        Returns:
            The attribute skinSlide:NAME:forceDensityMap, asset; invalid if there is none.
        """
        return self._attribute("forceDensityMap")

    def CreateForceDensityMapAttr(
        self, defaultValue: Sdf.AssetPath | str | os.PathLike[str] | None = None, writeSparsely: bool = False
    ) -> Usd.Attribute:
        """Authors skinSlide:NAME:forceDensityMap in the edit target.

        Args:
            defaultValue: Its default value, asset; None: none is authored.
            writeSparsely: Authors nothing if that is the fallback, and no other value is authored.

        Returns:
            The attribute.

        Raises:
            UsageError: The value is of another type.
        """
        return self._create_attribute("forceDensityMap", defaultValue, writeSparsely)

    def GetForceDensityMapChannelAttr(self) -> Usd.Attribute:
        """The channel of forceDensityMap to use: its name, or PART.NAME in a file of several parts.

        Absent: R, else Y, else the first that is not A; in a file of one layer, its own.

        Returns:
            The attribute skinSlide:NAME:forceDensityMapChannel, token, uniform; invalid if there is none.
        """
        return self._attribute("forceDensityMapChannel")

    def CreateForceDensityMapChannelAttr(
        self, defaultValue: str | None = None, writeSparsely: bool = False
    ) -> Usd.Attribute:
        """Authors skinSlide:NAME:forceDensityMapChannel in the edit target.

        Args:
            defaultValue: Its default value, token, uniform; None: none is authored.
            writeSparsely: Authors nothing if that is the fallback, and no other value is authored.

        Returns:
            The attribute.

        Raises:
            UsageError: The value is of another type.
        """
        return self._create_attribute("forceDensityMapChannel", defaultValue, writeSparsely)

    def GetWeightMapAttr(self) -> Usd.Attribute:
        """An OpenEXR image, one file or a UDIM (body.<UDIM>.exr): its values multiply the painted weight by point.

        Sampled as forceDensityMap is. May be animated. Absent: none.

        Returns:
            The attribute skinSlide:NAME:weightMap, asset; invalid if there is none.
        """
        return self._attribute("weightMap")

    def CreateWeightMapAttr(
        self, defaultValue: Sdf.AssetPath | str | os.PathLike[str] | None = None, writeSparsely: bool = False
    ) -> Usd.Attribute:
        """Authors skinSlide:NAME:weightMap in the edit target.

        Args:
            defaultValue: Its default value, asset; None: none is authored.
            writeSparsely: Authors nothing if that is the fallback, and no other value is authored.

        Returns:
            The attribute.

        Raises:
            UsageError: The value is of another type.
        """
        return self._create_attribute("weightMap", defaultValue, writeSparsely)

    def GetWeightMapChannelAttr(self) -> Usd.Attribute:
        """The channel of weightMap to use: its name, or PART.NAME in a file of several parts.

        Absent: R, else Y, else the first that is not A; in a file of one layer, its own.

        Returns:
            The attribute skinSlide:NAME:weightMapChannel, token, uniform; invalid if there is none.
        """
        return self._attribute("weightMapChannel")

    def CreateWeightMapChannelAttr(self, defaultValue: str | None = None, writeSparsely: bool = False) -> Usd.Attribute:
        """Authors skinSlide:NAME:weightMapChannel in the edit target.

        Args:
            defaultValue: Its default value, token, uniform; None: none is authored.
            writeSparsely: Authors nothing if that is the fallback, and no other value is authored.

        Returns:
            The attribute.

        Raises:
            UsageError: The value is of another type.
        """
        return self._create_attribute("weightMapChannel", defaultValue, writeSparsely)

    def GetHoldMapAttr(self) -> Usd.Attribute:
        """An OpenEXR image, one file or a UDIM (body.<UDIM>.exr): its values multiply the painted hold by point.

        Sampled as forceDensityMap is. Values must be above 0. May be animated. Absent: none.

        Returns:
            The attribute skinSlide:NAME:holdMap, asset; invalid if there is none.
        """
        return self._attribute("holdMap")

    def CreateHoldMapAttr(
        self, defaultValue: Sdf.AssetPath | str | os.PathLike[str] | None = None, writeSparsely: bool = False
    ) -> Usd.Attribute:
        """Authors skinSlide:NAME:holdMap in the edit target.

        Args:
            defaultValue: Its default value, asset; None: none is authored.
            writeSparsely: Authors nothing if that is the fallback, and no other value is authored.

        Returns:
            The attribute.

        Raises:
            UsageError: The value is of another type.
        """
        return self._create_attribute("holdMap", defaultValue, writeSparsely)

    def GetHoldMapChannelAttr(self) -> Usd.Attribute:
        """The channel of holdMap to use: its name, or PART.NAME in a file of several parts.

        Absent: R, else Y, else the first that is not A; in a file of one layer, its own.

        Returns:
            The attribute skinSlide:NAME:holdMapChannel, token, uniform; invalid if there is none.
        """
        return self._attribute("holdMapChannel")

    def CreateHoldMapChannelAttr(self, defaultValue: str | None = None, writeSparsely: bool = False) -> Usd.Attribute:
        """Authors skinSlide:NAME:holdMapChannel in the edit target.

        Args:
            defaultValue: Its default value, token, uniform; None: none is authored.
            writeSparsely: Authors nothing if that is the fallback, and no other value is authored.

        Returns:
            The attribute.

        Raises:
            UsageError: The value is of another type.
        """
        return self._create_attribute("holdMapChannel", defaultValue, writeSparsely)

    def GetPaintChannelAttr(self) -> Usd.Attribute:
        """Which number counts of paint with several for each point, such as a colour: r is the first, g the second.

        none: paint must have one number.

        Returns:
            The attribute skinSlide:NAME:paintChannel, token, uniform; invalid if there is none.
        """
        return self._attribute("paintChannel")

    def CreatePaintChannelAttr(
        self, defaultValue: Literal["none", "r", "g", "b", "a"] | None = None, writeSparsely: bool = False
    ) -> Usd.Attribute:
        """Authors skinSlide:NAME:paintChannel in the edit target.

        Args:
            defaultValue: Its default value, token, uniform; None: none is authored.
            writeSparsely: Authors nothing if that is the fallback, and no other value is authored.

        Returns:
            The attribute.

        Raises:
            UsageError: The value is of another type.
        """
        return self._create_attribute("paintChannel", defaultValue, writeSparsely)

    def GetMapStAttr(self) -> Usd.Attribute:
        """The primvar with the texture coordinates at which all maps are sampled.

        Two floats each; faceVarying, vertex or varying. Beyond 0 to 1 an image continues as its attribute wrapmodes
        says; without that it is clamped.

        Returns:
            The attribute skinSlide:NAME:mapSt, token, uniform; invalid if there is none.
        """
        return self._attribute("mapSt")

    def CreateMapStAttr(self, defaultValue: str | None = None, writeSparsely: bool = False) -> Usd.Attribute:
        """Authors skinSlide:NAME:mapSt in the edit target.

        Args:
            defaultValue: Its default value, token, uniform; None: none is authored.
            writeSparsely: Authors nothing if that is the fallback, and no other value is authored.

        Returns:
            The attribute.

        Raises:
            UsageError: The value is of another type.
        """
        return self._create_attribute("mapSt", defaultValue, writeSparsely)

    def GetPatchPrimvar(self) -> UsdGeom.Primvar:
        """The faces.

        bool[], int[] or numbers; uniform: faces of value above 0; vertex: faces whose points are all above 0. Where
        it is absent, the GeomSubset child called NAME (elementType face) gives them. Faces that fall into several
        pieces are several patches with the same settings.

        Returns:
            The primvar primvars:skinSlide:NAME:patch; invalid if there is none.
        """
        return self._primvar("patch")

    def CreatePatchPrimvar(
        self, interpolation: str = "uniform", defaultValue: npt.ArrayLike | None = None
    ) -> UsdGeom.Primvar:
        """Authors primvars:skinSlide:NAME:patch in the edit target.

        Args:
            interpolation: Which elements of the mesh have a value each.
            defaultValue: Its default value, bool[], not indexed; None: none is authored.

        Returns:
            The primvar.

        Raises:
            UsageError: The values are of another type.
        """
        return self._create_primvar("patch", "bool[]", interpolation, defaultValue)

    def GetWeightPrimvar(self) -> UsdGeom.Primvar:
        """How far each point slides, 0 to 1.

        float, vertex or constant; may be animated. Absent: 1. With interpolation limit it scales the slide of limit
        points: a point of weight 0 still follows its neighbours so that its limit point stays.

        Returns:
            The primvar primvars:skinSlide:NAME:weight; invalid if there is none.
        """
        return self._primvar("weight")

    def CreateWeightPrimvar(
        self, interpolation: str = "vertex", defaultValue: npt.ArrayLike | None = None
    ) -> UsdGeom.Primvar:
        """Authors primvars:skinSlide:NAME:weight in the edit target.

        Args:
            interpolation: Which elements of the mesh have a value each.
            defaultValue: Its default value, float[], not indexed; None: none is authored.

        Returns:
            The primvar.

        Raises:
            UsageError: The values are of another type.
        """
        return self._create_primvar("weight", "float[]", interpolation, defaultValue)

    def GetMaxDistancePrimvar(self) -> UsdGeom.Primvar:
        """How far each point may slide along the surface, in the mesh's units.

        float, 0 or more, vertex or constant; may be animated. Absent: no limit.

        Returns:
            The primvar primvars:skinSlide:NAME:maxDistance; invalid if there is none.
        """
        return self._primvar("maxDistance")

    def CreateMaxDistancePrimvar(
        self, interpolation: str = "vertex", defaultValue: npt.ArrayLike | None = None
    ) -> UsdGeom.Primvar:
        """Authors primvars:skinSlide:NAME:maxDistance in the edit target.

        Args:
            interpolation: Which elements of the mesh have a value each.
            defaultValue: Its default value, float[], not indexed; None: none is authored.

        Returns:
            The primvar.

        Raises:
            UsageError: The values are of another type.
        """
        return self._create_primvar("maxDistance", "float[]", interpolation, defaultValue)

    def GetForceDensityPrimvar(self) -> UsdGeom.Primvar:
        """How hard edges pull.

        float above 0; vertex (an edge takes the mean of its ends), uniform (the mean of its faces) or constant; may
        be animated. Only ratios matter. Absent: 1.

        Returns:
            The primvar primvars:skinSlide:NAME:forceDensity; invalid if there is none.
        """
        return self._primvar("forceDensity")

    def CreateForceDensityPrimvar(
        self, interpolation: str = "vertex", defaultValue: npt.ArrayLike | None = None
    ) -> UsdGeom.Primvar:
        """Authors primvars:skinSlide:NAME:forceDensity in the edit target.

        Args:
            interpolation: Which elements of the mesh have a value each.
            defaultValue: Its default value, float[], not indexed; None: none is authored.

        Returns:
            The primvar.

        Raises:
            UsageError: The values are of another type.
        """
        return self._create_primvar("forceDensity", "float[]", interpolation, defaultValue)

    def GetHoldPrimvar(self) -> UsdGeom.Primvar:
        """How closely each point follows the slide of its neighbours, under the rules relaxed and even.

        Low where surplus skin is to come from, high where it must not. float above 0, vertex or constant; far under
        0.1 nothing keeps skin from sliding at random; may be animated. Absent: 1.

        Returns:
            The primvar primvars:skinSlide:NAME:hold; invalid if there is none.
        """
        return self._primvar("hold")

    def CreateHoldPrimvar(
        self, interpolation: str = "vertex", defaultValue: npt.ArrayLike | None = None
    ) -> UsdGeom.Primvar:
        """Authors primvars:skinSlide:NAME:hold in the edit target.

        Args:
            interpolation: Which elements of the mesh have a value each.
            defaultValue: Its default value, float[], not indexed; None: none is authored.

        Returns:
            The primvar.

        Raises:
            UsageError: The values are of another type.
        """
        return self._create_primvar("hold", "float[]", interpolation, defaultValue)


class SkinSlideMeshAPI(AppliedSchema):
    """What all patches of a mesh share.

    Its attributes count on every mesh with patches, whether it is applied or not.
    """

    SCHEMA = "SkinSlideMeshAPI"
    NAMESPACE = "skinSlide"
    APPLIES_TO = ("Mesh",)

    def GetRestPointsAttr(self) -> Usd.Attribute:
        """The rest pose, in which nothing slides: as many points as the mesh has.

        Absent: the first found of primvars:rest, primvars:pref, primvars:Pref, primvars:__Pref and the default value
        of points.

        Returns:
            The attribute skinSlide:restPoints, point3f[], uniform; invalid if there is none.
        """
        return self._attribute("restPoints")

    def CreateRestPointsAttr(
        self, defaultValue: npt.ArrayLike | None = None, writeSparsely: bool = False
    ) -> Usd.Attribute:
        """Authors skinSlide:restPoints in the edit target.

        Args:
            defaultValue: Its default value, point3f[], uniform; None: none is authored.
            writeSparsely: Authors nothing if that is the fallback, and no other value is authored.

        Returns:
            The attribute.

        Raises:
            UsageError: The value is of another type.
        """
        return self._create_attribute("restPoints", defaultValue, writeSparsely)

    def GetWeldAttr(self) -> Usd.Attribute:
        """Whether points in one place are one.

        Those that coincide at rest and at every sample of points, and whose faces meet there edge to edge, such as
        both sides of a UV seam. Patches continue across them, they move together, and of what is painted on them the
        mean counts. Points that part during the shot, or would give an edge more than two faces, are not one; check
        names them. Where holes is free, borders stay where another mesh in the same space has points at the first
        time, so that no crack opens.

        Returns:
            The attribute skinSlide:weld, bool, uniform; invalid if there is none.
        """
        return self._attribute("weld")

    def CreateWeldAttr(self, defaultValue: bool | None = None, writeSparsely: bool = False) -> Usd.Attribute:
        """Authors skinSlide:weld in the edit target.

        Args:
            defaultValue: Its default value, bool, uniform; None: none is authored.
            writeSparsely: Authors nothing if that is the fallback, and no other value is authored.

        Returns:
            The attribute.

        Raises:
            UsageError: The value is of another type.
        """
        return self._create_attribute("weld", defaultValue, writeSparsely)

    def GetWeldToleranceAttr(self) -> Usd.Attribute:
        """The distance within which points are in one place for weld, in the mesh's units.

        0 to a thousandth of its size. 0: where their coordinates are equal.

        Returns:
            The attribute skinSlide:weldTolerance, float, uniform; invalid if there is none.
        """
        return self._attribute("weldTolerance")

    def CreateWeldToleranceAttr(self, defaultValue: float | None = None, writeSparsely: bool = False) -> Usd.Attribute:
        """Authors skinSlide:weldTolerance in the edit target.

        Args:
            defaultValue: Its default value, float, uniform; None: none is authored.
            writeSparsely: Authors nothing if that is the fallback, and no other value is authored.

        Returns:
            The attribute.

        Raises:
            UsageError: The value is of another type.
        """
        return self._create_attribute("weldTolerance", defaultValue, writeSparsely)

    def GetWorldSpaceAttr(self) -> Usd.Attribute:
        """Whether lengths are those in the world.

        At rest and at every frame they are measured as the transforms above the mesh scale it, which matters where a
        scale is not the same in all directions. Distances such as grow of patches stay in the mesh's units, and
        maxDistance is in the world's. Over time the transforms may rotate, move and scale the mesh, but not change
        how much more they scale it one way than another.

        Returns:
            The attribute skinSlide:worldSpace, bool, uniform; invalid if there is none.
        """
        return self._attribute("worldSpace")

    def CreateWorldSpaceAttr(self, defaultValue: bool | None = None, writeSparsely: bool = False) -> Usd.Attribute:
        """Authors skinSlide:worldSpace in the edit target.

        Args:
            defaultValue: Its default value, bool, uniform; None: none is authored.
            writeSparsely: Authors nothing if that is the fallback, and no other value is authored.

        Returns:
            The attribute.

        Raises:
            UsageError: The value is of another type.
        """
        return self._create_attribute("worldSpace", defaultValue, writeSparsely)

    def GetFoldCaseAttr(self) -> Usd.Attribute:
        """Whether paint counts under names in any case.

        Some tools write skinslide_elbow_l_weight for skinSlide:elbow_L:weight.

        Returns:
            The attribute skinSlide:foldCase, bool, uniform; invalid if there is none.
        """
        return self._attribute("foldCase")

    def CreateFoldCaseAttr(self, defaultValue: bool | None = None, writeSparsely: bool = False) -> Usd.Attribute:
        """Authors skinSlide:foldCase in the edit target.

        Args:
            defaultValue: Its default value, bool, uniform; None: none is authored.
            writeSparsely: Authors nothing if that is the fallback, and no other value is authored.

        Returns:
            The attribute.

        Raises:
            UsageError: The value is of another type.
        """
        return self._create_attribute("foldCase", defaultValue, writeSparsely)

    def GetCompareRestAttr(self) -> Usd.Attribute:
        """Whether rest is compared with the first sample of points, by the lengths of edges.

        Rest whose scale differs by more than a factor of 2 is taken at the scale of the cache, with a warning. There
        is a warning of a patch on which rest resembles the cache poorly; one on which it hardly does, as when points
        are in another order, cannot be slid. Off: rest is taken as it is.

        Returns:
            The attribute skinSlide:compareRest, bool, uniform; invalid if there is none.
        """
        return self._attribute("compareRest")

    def CreateCompareRestAttr(self, defaultValue: bool | None = None, writeSparsely: bool = False) -> Usd.Attribute:
        """Authors skinSlide:compareRest in the edit target.

        Args:
            defaultValue: Its default value, bool, uniform; None: none is authored.
            writeSparsely: Authors nothing if that is the fallback, and no other value is authored.

        Returns:
            The attribute.

        Raises:
            UsageError: The value is of another type.
        """
        return self._create_attribute("compareRest", defaultValue, writeSparsely)


class SkinSlideLiveAPI(AppliedSchema):
    """What a shot sets for all patches of a .skinslide file, on the prim that payloads it.

    Its attributes count on every such prim, whether it is applied or not.
    """

    SCHEMA = "SkinSlideLiveAPI"
    NAMESPACE = "skinSlide:live"
    APPLIES_TO = ()

    def GetEnvelopeAttr(self) -> Usd.Attribute:
        """Multiplies the envelope of each patch.

        Returns:
            The attribute skinSlide:live:envelope, float, uniform; invalid if there is none.
        """
        return self._attribute("envelope")

    def CreateEnvelopeAttr(self, defaultValue: float | None = None, writeSparsely: bool = False) -> Usd.Attribute:
        """Authors skinSlide:live:envelope in the edit target.

        Args:
            defaultValue: Its default value, float, uniform; None: none is authored.
            writeSparsely: Authors nothing if that is the fallback, and no other value is authored.

        Returns:
            The attribute.

        Raises:
            UsageError: The value is of another type.
        """
        return self._create_attribute("envelope", defaultValue, writeSparsely)

    def GetInterpolationAttr(self) -> Usd.Attribute:
        """Replaces the interpolation of each patch.

        Absent: each has its own.

        Returns:
            The attribute skinSlide:live:interpolation, token, uniform; invalid if there is none.
        """
        return self._attribute("interpolation")

    def CreateInterpolationAttr(
        self, defaultValue: Literal["auto", "linear", "meanValue", "limit"] | None = None, writeSparsely: bool = False
    ) -> Usd.Attribute:
        """Authors skinSlide:live:interpolation in the edit target.

        Args:
            defaultValue: Its default value, token, uniform; None: none is authored.
            writeSparsely: Authors nothing if that is the fallback, and no other value is authored.

        Returns:
            The attribute.

        Raises:
            UsageError: The value is of another type.
        """
        return self._create_attribute("interpolation", defaultValue, writeSparsely)

    def GetLookupAttr(self) -> Usd.Attribute:
        """How rest points are looked up in the plane; the result is the same.

        auto: egl where there is a graphics device, else exact.

        Returns:
            The attribute skinSlide:live:lookup, token, uniform; invalid if there is none.
        """
        return self._attribute("lookup")

    def CreateLookupAttr(
        self, defaultValue: Literal["auto", "egl", "exact"] | None = None, writeSparsely: bool = False
    ) -> Usd.Attribute:
        """Authors skinSlide:live:lookup in the edit target.

        Args:
            defaultValue: Its default value, token, uniform; None: none is authored.
            writeSparsely: Authors nothing if that is the fallback, and no other value is authored.

        Returns:
            The attribute.

        Raises:
            UsageError: The value is of another type.
        """
        return self._create_attribute("lookup", defaultValue, writeSparsely)
