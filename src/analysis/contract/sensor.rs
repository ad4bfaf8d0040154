//! What sensors give, by their messages: the size of images, rings and fields of clouds, rays of scans.

use crate::source::MessageRef;
use crate::world::bag::TopicEvidence;
use crate::world::contract::SensorTerms;

/// What the messages of a topic hold: all different values that were seen, each with its first message.
pub(crate) struct SensorSeen<'w> {
    /// Width and height, pixels: of images, and of the images that calibrations are for.
    pub(crate) images: Vec<([u32; 2], &'w MessageRef)>,
    /// The most rings of a cloud.
    pub(crate) rings: Option<(u32, &'w MessageRef)>,
    /// The most rays of a scan.
    pub(crate) rays: Option<(u32, &'w MessageRef)>,
    /// The fields of points.
    pub(crate) fields: Vec<(Vec<&'w str>, &'w MessageRef)>,
}

impl<'w> SensorSeen<'w> {
    pub(crate) fn of(topic: &'w TopicEvidence) -> Self {
        let content = &topic.content;
        let forms = content.images.iter().flat_map(|images| &images.forms);
        let forms = forms.map(|form| (form.size, &form.at));
        let calibrations = content.calibrations.iter().flat_map(|known| &known.calibrations);
        let calibrations = calibrations.map(|known| (known.camera.size, &known.at));
        let mut images: Vec<([u32; 2], &MessageRef)> = forms.chain(calibrations).collect();
        images.retain(|(size, _)| *size != [0; 2]);
        images.dedup_by_key(|(size, _)| *size);
        let clouds = content.clouds.as_ref();
        let samples = clouds.into_iter().flat_map(|clouds| &clouds.samples);
        // The layout of a decoded cloud is not the recording's.
        let published = clouds.into_iter().filter(|clouds| clouds.packets.is_none());
        let layouts = published.flat_map(|clouds| &clouds.layouts);
        let most = |(most, at): (u32, &'w MessageRef), (count, other): (u32, &'w MessageRef)| {
            if count > most { (count, other) } else { (most, at) }
        };
        let laser = content.lasers.as_deref();
        Self {
            images,
            rings: samples
                .filter_map(|sample| Some((sample.rings?, &sample.at)))
                .reduce(most),
            rays: laser.and_then(|laser| Some((laser.scans.iter().map(|scan| scan.rays).max()?, &laser.first))),
            fields: layouts
                .map(|layout| {
                    let names = layout.fields.iter().map(|field| field.name.as_str());
                    (names.collect(), &layout.at)
                })
                .collect(),
        }
    }

    /// The terms that it gives; what differs between its messages gives none.
    fn terms(&self) -> SensorTerms {
        SensorTerms {
            image: match self.images.as_slice() {
                [(size, _)] => Some(*size),
                _ => None,
            },
            rings: self.rings.map(|(rings, _)| rings),
            rays: self.rays.map(|(rays, _)| rays),
            fields: match self.fields.as_slice() {
                [(names, _)] => names.iter().map(|name| (*name).to_owned()).collect(),
                _ => Vec::new(),
            },
        }
    }
}

/// The terms of a sensor that all of these recordings give.
pub(super) fn terms<'w>(topics: impl Iterator<Item = &'w TopicEvidence>) -> SensorTerms {
    let all = topics.map(|topic| SensorSeen::of(topic).terms());
    let same = all.reduce(|a, b| SensorTerms {
        image: a.image.filter(|image| b.image == Some(*image)),
        rings: a.rings.filter(|rings| b.rings == Some(*rings)),
        rays: a.rays.filter(|rays| b.rays == Some(*rays)),
        fields: if a.fields == b.fields { a.fields } else { Vec::new() },
    });
    same.unwrap_or_default()
}
