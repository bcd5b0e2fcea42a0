//! Ablations: kits that leave a part of the model out, to hear what it does (scraping-rolling §3).

/// Part of the model that is left out.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ablation {
    /// Limit of the path's curvature (eq. 4): `S'' = z''`.
    Nonlinearity,
    /// Normal force: the limit stays at its mean (eq. 6 to 9).
    NormalForce,
    /// Modes of the scraper.
    Scraper,
}

/// Product of limit and largest curvature at which the path counts as unlimited: tanh differs by
/// 0.3 %.
const UNLIMITED: f64 = 0.1;

/// Kit without parts of the model, for a motion on some of its pads. [`Ablation::NormalForce`]
/// takes the ups and downs of balls alone: leave the rest out of [`events`](super::events) and
/// [`render`](super::render).
pub fn without(kit: &kit::Kit, ablations: &[Ablation], pads: &[u8]) -> kit::Kit {
    let mut kit = kit.clone();
    if ablations.contains(&Ablation::Scraper) {
        kit.pads.iter_mut().for_each(|pad| pad.striker_weight = 0.0);
    }
    if ablations.contains(&Ablation::NormalForce) {
        kit.strikers.iter_mut().filter_map(|striker| striker.roll.as_mut()).for_each(|roll| roll.modulation = 0.0);
    }
    if ablations.contains(&Ablation::Nonlinearity) {
        let objects = pads.iter().filter_map(|&pad| {
            let name = &kit.pads.get(usize::from(pad))?.object;
            kit.objects.iter().find(|object| object.name == *name)?.surface.as_ref()
        });
        let surfaces = objects.filter_map(|place| kit.surfaces.iter().find(|surface| surface.name == place.surface));
        // A striker has one limit for all surfaces: that of the roughest one.
        let largest = surfaces.map(kit::Surface::largest_curvature_per_m).fold(0.0, f64::max);
        let alpha_m = (UNLIMITED / largest) as f32;
        for scrape in kit.strikers.iter_mut().filter_map(|striker| striker.scrape.as_mut()) {
            (scrape.alpha_min_m, scrape.alpha_max_m) = (Some(alpha_m), Some(alpha_m));
        }
    }
    kit
}
