(* Bounded, passive and free of drift: lugre, lugre_majorant, elastoplastic, elastoplastic_majorant, dahl. *)
From Coq Require Import Reals Lra Psatz.
From Coquelicot Require Import Coquelicot.
From Stribeck Require Import Laws Motion Power Terms Continuous Relaxation.
Open Scope R_scope.

(* --- the shares of plastic motion ------------------------------------------------------------------------------------ *)

Definition all_plastic (_ : constants) (_ _ : R) : R := 1.
Definition exact_abs (_ : constants) (v : R) : R := Rabs v.
Definition no_excess (_ : constants) : R := 0.
Definition excess_atan (p : constants) : R := 2 / (PI * k_v p).
Definition excess_sqrt (p : constants) : R := 1 / k_v p.
Definition excess_compact (p : constants) : R := 3 / (8 * k_v p).

Lemma a_range p v z : 0 <= a p v z <= 1.
Proof. rewrite a_is. apply smoothstep_range. Qed.

Lemma a_beyond p v z : z_ba p < g p v -> g p v <= Rabs z -> a p v z = 1.
Proof. intros H Hz. rewrite a_is. apply smoothstep_high, yielded_high; assumption. Qed.

Lemma a_elastic p v z : z_ba p < g p v -> Rabs z <= z_ba p -> a p v z = 0.
Proof. intros H Hz. rewrite a_is. apply smoothstep_low, yielded_low; assumption. Qed.

Lemma alpha_range p v z : z_ba p < g p v -> 0 <= alpha p v z <= 1.
Proof. intros H. unfold alpha. destruct (Rle_dec (v * z) 0); [lra|]. rewrite alpha_0_is by exact H. apply sine_step_range. Qed.

Lemma alpha_beyond p v z : z_ba p < g p v -> g p v <= Rabs z -> alpha p v z = 1 \/ (v * z <= 0 /\ alpha p v z = 0).
Proof.
  intros H Hz. unfold alpha. destruct (Rle_dec (v * z) 0) as [L | L]; [right; auto|left].
  rewrite alpha_0_is by exact H. apply sine_step_high, yielded_high; assumption.
Qed.

Lemma alpha_elastic p v z : Rabs z <= z_ba p -> alpha p v z = 0.
Proof. intros H. unfold alpha, alpha_0. destruct (Rle_dec (v * z) 0), (Rle_dec (Rabs z) (z_ba p)); lra. Qed.

(* --- the laws are of the form of Relaxation.v --------------------------------------------------------------------------- *)

Ltac known H := unfold lugre.allowed, lugre_majorant.allowed, lugre_majorant_sqrt.allowed, lugre_majorant_compact.allowed,
  elastoplastic.allowed, elastoplastic_majorant.allowed, elastoplastic_majorant_sqrt.allowed,
  elastoplastic_majorant_compact.allowed in H; simpl in H;
  repeat match goal with K : _ /\ _ |- _ => destruct K end.
Ltac allowed := intros; repeat match goal with H : _ |- _ => progress known H end; simpl;
  unfold lugre.allowed, lugre_majorant.allowed, lugre_majorant_sqrt.allowed, lugre_majorant_compact.allowed,
    elastoplastic.allowed, elastoplastic_majorant.allowed, elastoplastic_majorant_sqrt.allowed,
    elastoplastic_majorant_compact.allowed; simpl; repeat split; try lra.
(* |m| and the level of a law; its rate; its continuity. *)
Ltac form rate_def continuity :=
  split; unfold exact_abs, no_excess, all_plastic; try (allowed; fail);
  try match goal with
    | |- forall p v z, _ -> _ = _ => intros p v z H; unfold rate_def; known H; pose proof (g_pos p v); field; lra
    | |- forall U : UniformSpace, _ => intros U p vel Fc Fs H Hv Hc Hs L; known H; apply continuity; auto;
      intros w; specialize (L w); lra
  end.
Ltac below_g := match goal with H : _ |- z_ba ?p < g ?p ?v => known H; apply z_ba_below; lra end.

Lemma lugre_form : relaxation lugre.allowed lugre.dz_dt exact_abs no_excess all_plastic.
Proof.
  form lugre.dz_dt @c_lugre.
Qed.
Lemma lugre_majorant_form : relaxation lugre_majorant.allowed lugre_majorant.dz_dt m_atan excess_atan all_plastic.
Proof.
  form lugre_majorant.dz_dt @c_lugre_majorant.
  - intros p v H. known H. apply m_atan_majorant; lra.
Qed.
Lemma lugre_majorant_sqrt_form : relaxation lugre_majorant_sqrt.allowed lugre_majorant_sqrt.dz_dt m_sqrt excess_sqrt all_plastic.
Proof.
  form lugre_majorant_sqrt.dz_dt @c_lugre_majorant_sqrt.
  - intros p v H. known H. apply m_sqrt_majorant; lra.
Qed.
Lemma lugre_majorant_compact_form : relaxation lugre_majorant_compact.allowed lugre_majorant_compact.dz_dt m_compact excess_compact all_plastic.
Proof.
  form lugre_majorant_compact.dz_dt @c_lugre_majorant_compact.
  - intros p v H. known H. apply m_compact_majorant; lra.
Qed.
Lemma elastoplastic_form : relaxation elastoplastic.allowed elastoplastic.dz_dt exact_abs no_excess alpha.
Proof.
  form elastoplastic.dz_dt @c_elastoplastic.
  - intros p v z H. apply alpha_range. below_g.
  - intros p v z H Hz. apply alpha_beyond; [below_g|exact Hz].
Qed.
Lemma elastoplastic_majorant_form : relaxation elastoplastic_majorant.allowed elastoplastic_majorant.dz_dt m_atan excess_atan a.
Proof.
  form elastoplastic_majorant.dz_dt @c_elastoplastic_majorant.
  - intros p v H. known H. apply m_atan_majorant; lra.
  - intros p v z H. apply a_range.
  - intros p v z H Hz. left. apply a_beyond; [below_g|exact Hz].
Qed.
Lemma elastoplastic_majorant_sqrt_form : relaxation elastoplastic_majorant_sqrt.allowed elastoplastic_majorant_sqrt.dz_dt m_sqrt excess_sqrt a.
Proof.
  form elastoplastic_majorant_sqrt.dz_dt @c_elastoplastic_majorant_sqrt.
  - intros p v H. known H. apply m_sqrt_majorant; lra.
  - intros p v z H. apply a_range.
  - intros p v z H Hz. left. apply a_beyond; [below_g|exact Hz].
Qed.
Lemma elastoplastic_majorant_compact_form : relaxation elastoplastic_majorant_compact.allowed elastoplastic_majorant_compact.dz_dt m_compact excess_compact a.
Proof.
  form elastoplastic_majorant_compact.dz_dt @c_elastoplastic_majorant_compact.
  - intros p v H. known H. apply m_compact_majorant; lra.
  - intros p v z H. apply a_range.
  - intros p v z H Hz. left. apply a_beyond; [below_g|exact Hz].
Qed.

(* --- damping of the bristles: constant, or falling with speed ------------------------------------------------------------ *)

Definition constant_damping (p : constants) (_ : R) : R := sigma_1 p.

Lemma constant_damping_continuous p v : continuous (T := R_UniformSpace) (constant_damping p) v.
Proof. apply continuous_const. Qed.

Lemma sigma_1_at_continuous p v : continuous (T := R_UniformSpace) (sigma_1_at p) v.
Proof.
  apply (@ex_derive_continuous R_AbsRing R_NormedModule). unfold sigma_1_at, Rdiv. set (c := / v_d p). auto_derive. exact I.
Qed.

Ltac by_law form damping :=
  match goal with H : _ |- _ => pose proof (r_constants _ _ _ _ _ form _ H) as Known end;
  first [apply (law_stores _ _ _ _ _ damping _ form) | apply (varying_stores _ _ _ _ _ damping _ form)
    | apply (law_stores_damped _ _ _ _ _ damping _ form) | apply (varying_stores_damped _ _ _ _ _ damping _ form)];
  auto using constant_damping_continuous, sigma_1_at_continuous;
  try (intros q v K; pose proof (r_constants _ _ _ _ _ form _ K);
    first [apply sigma_1_at_range; lra | unfold constant_damping; lra]).

(* --- bounded ------------------------------------------------------------------------------------------------------------ *)

Theorem lugre_bounded p : lugre.allowed p -> keeps (U := R_UniformSpace) (lugre.dz_dt p) any (lugre.z_bound p).
Proof. intros H v z a b M _. apply (law_bounded _ _ _ _ _ lugre_form p H v z a b M). Qed.
Theorem lugre_majorant_bounded p : lugre_majorant.allowed p -> keeps (U := R_UniformSpace) (lugre_majorant.dz_dt p) any (lugre_majorant.z_bound p).
Proof. intros H v z a b M _. apply (law_bounded _ _ _ _ _ lugre_majorant_form p H v z a b M). Qed.
Theorem lugre_majorant_sqrt_bounded p : lugre_majorant_sqrt.allowed p -> keeps (U := R_UniformSpace) (lugre_majorant_sqrt.dz_dt p) any (lugre_majorant_sqrt.z_bound p).
Proof. intros H v z a b M _. apply (law_bounded _ _ _ _ _ lugre_majorant_sqrt_form p H v z a b M). Qed.
Theorem lugre_majorant_compact_bounded p : lugre_majorant_compact.allowed p -> keeps (U := R_UniformSpace) (lugre_majorant_compact.dz_dt p) any (lugre_majorant_compact.z_bound p).
Proof. intros H v z a b M _. apply (law_bounded _ _ _ _ _ lugre_majorant_compact_form p H v z a b M). Qed.
Theorem elastoplastic_bounded p : elastoplastic.allowed p -> keeps (U := R_UniformSpace) (elastoplastic.dz_dt p) any (elastoplastic.z_bound p).
Proof. intros H v z a b M _. apply (law_bounded _ _ _ _ _ elastoplastic_form p H v z a b M). Qed.
Theorem elastoplastic_majorant_bounded p : elastoplastic_majorant.allowed p -> keeps (U := R_UniformSpace) (elastoplastic_majorant.dz_dt p) any (elastoplastic_majorant.z_bound p).
Proof. intros H v z a b M _. apply (law_bounded _ _ _ _ _ elastoplastic_majorant_form p H v z a b M). Qed.
Theorem elastoplastic_majorant_sqrt_bounded p : elastoplastic_majorant_sqrt.allowed p -> keeps (U := R_UniformSpace) (elastoplastic_majorant_sqrt.dz_dt p) any (elastoplastic_majorant_sqrt.z_bound p).
Proof. intros H v z a b M _. apply (law_bounded _ _ _ _ _ elastoplastic_majorant_sqrt_form p H v z a b M). Qed.
Theorem elastoplastic_majorant_compact_bounded p : elastoplastic_majorant_compact.allowed p -> keeps (U := R_UniformSpace) (elastoplastic_majorant_compact.dz_dt p) any (elastoplastic_majorant_compact.z_bound p).
Proof. intros H v z a b M _. apply (law_bounded _ _ _ _ _ elastoplastic_majorant_compact_form p H v z a b M). Qed.

(* --- passive, with the bristles' elastic energy as storage, under the condition that the law claims ----------------------- *)

Theorem lugre_passive p : lugre.allowed p -> lugre.claims_passive p ->
  storage (U := R_UniformSpace) (lugre.dz_dt p) any (power_of (lugre.friction p)) (within (lugre.z_bound p)) (lugre.stored_energy p).
Proof. intros H HL. by_law lugre_form constant_damping. unfold no_excess; lra. Qed.
Theorem lugre_majorant_passive p : lugre_majorant.allowed p -> lugre_majorant.claims_passive p ->
  storage (U := R_UniformSpace) (lugre_majorant.dz_dt p) any (power_of (lugre_majorant.friction p)) (within (lugre_majorant.z_bound p)) (lugre_majorant.stored_energy p).
Proof. intros H [HL Hm]. by_law lugre_majorant_form constant_damping. Qed.
Theorem lugre_majorant_sqrt_passive p : lugre_majorant_sqrt.allowed p -> lugre_majorant_sqrt.claims_passive p ->
  storage (U := R_UniformSpace) (lugre_majorant_sqrt.dz_dt p) any (power_of (lugre_majorant_sqrt.friction p)) (within (lugre_majorant_sqrt.z_bound p)) (lugre_majorant_sqrt.stored_energy p).
Proof. intros H [HL Hm]. by_law lugre_majorant_sqrt_form constant_damping. Qed.
Theorem lugre_majorant_compact_passive p : lugre_majorant_compact.allowed p -> lugre_majorant_compact.claims_passive p ->
  storage (U := R_UniformSpace) (lugre_majorant_compact.dz_dt p) any (power_of (lugre_majorant_compact.friction p)) (within (lugre_majorant_compact.z_bound p)) (lugre_majorant_compact.stored_energy p).
Proof. intros H [HL Hm]. by_law lugre_majorant_compact_form constant_damping. Qed.
Theorem elastoplastic_passive p : elastoplastic.allowed p -> elastoplastic.claims_passive p ->
  storage (U := R_UniformSpace) (elastoplastic.dz_dt p) any (power_of (elastoplastic.friction p)) (within (elastoplastic.z_bound p)) (elastoplastic.stored_energy p).
Proof. intros H HL. by_law elastoplastic_form constant_damping. unfold no_excess; lra. Qed.
Theorem elastoplastic_majorant_passive p : elastoplastic_majorant.allowed p -> elastoplastic_majorant.claims_passive p ->
  storage (U := R_UniformSpace) (elastoplastic_majorant.dz_dt p) any (power_of (elastoplastic_majorant.friction p)) (within (elastoplastic_majorant.z_bound p)) (elastoplastic_majorant.stored_energy p).
Proof. intros H [HL Hm]. by_law elastoplastic_majorant_form constant_damping. Qed.
Theorem elastoplastic_majorant_sqrt_passive p : elastoplastic_majorant_sqrt.allowed p -> elastoplastic_majorant_sqrt.claims_passive p ->
  storage (U := R_UniformSpace) (elastoplastic_majorant_sqrt.dz_dt p) any (power_of (elastoplastic_majorant_sqrt.friction p)) (within (elastoplastic_majorant_sqrt.z_bound p)) (elastoplastic_majorant_sqrt.stored_energy p).
Proof. intros H [HL Hm]. by_law elastoplastic_majorant_sqrt_form constant_damping. Qed.
Theorem elastoplastic_majorant_compact_passive p : elastoplastic_majorant_compact.allowed p -> elastoplastic_majorant_compact.claims_passive p ->
  storage (U := R_UniformSpace) (elastoplastic_majorant_compact.dz_dt p) any (power_of (elastoplastic_majorant_compact.friction p)) (within (elastoplastic_majorant_compact.z_bound p)) (elastoplastic_majorant_compact.stored_energy p).
Proof. intros H [HL Hm]. by_law elastoplastic_majorant_compact_form constant_damping. Qed.

(* --- damping that falls with speed: for every z, whatever sigma_2 and F_s are ---------------------------------------------- *)

Definition damped (p : constants) (m0 : R) : Prop :=
  sigma_1 p * (v_d p / Rpower (2 * exp 1) (1 / 2) + m0) <= 4 * F_c p.

Lemma damped_bound p m0 v : 0 <= sigma_1 p -> 0 < v_d p -> 0 <= m0 -> damped p m0 ->
  sigma_1_at p v * (Rabs v + m0) <= 4 * F_c p.
Proof. intros H1 H2 H3 H4. apply Rle_trans with (2 := H4). apply sigma_1_at_damped; assumption. Qed.

Lemma excess_atan_nonneg p : 0 < k_v p -> 0 <= excess_atan p.
Proof. intros H. pose proof PI_RGT_0. apply Rlt_le, Rdiv_lt_0_compat; nra. Qed.
Lemma excess_sqrt_nonneg p : 0 < k_v p -> 0 <= excess_sqrt p.
Proof. intros H. apply Rlt_le, Rdiv_lt_0_compat; lra. Qed.
Lemma excess_compact_nonneg p : 0 < k_v p -> 0 <= excess_compact p.
Proof. intros H. apply Rlt_le, Rdiv_lt_0_compat; lra. Qed.
Lemma no_excess_nonneg p : 0 <= no_excess p.
Proof. unfold no_excess. lra. Qed.

Ltac known_v_d H := unfold lugre.allowed_v_d, lugre_majorant.allowed_v_d, lugre_majorant_sqrt.allowed_v_d,
  lugre_majorant_compact.allowed_v_d, elastoplastic.allowed_v_d, elastoplastic_majorant.allowed_v_d,
  elastoplastic_majorant_sqrt.allowed_v_d, elastoplastic_majorant_compact.allowed_v_d in H; simpl in H;
  repeat match goal with K : _ /\ _ |- _ => destruct K end.
Ltac by_damping H D :=
  intros v; apply damped_bound; try (known_v_d H; lra); try exact D;
  first [apply no_excess_nonneg | apply excess_atan_nonneg | apply excess_sqrt_nonneg | apply excess_compact_nonneg];
  known_v_d H; lra.

Theorem lugre_passive_damped p : lugre.allowed_v_d p -> damped p (no_excess p) ->
  storage (U := R_UniformSpace) (lugre.dz_dt p) any (power_of (lugre.friction_v_d p)) any (lugre.stored_energy p).
Proof.
  intros H D. assert (H' : lugre.allowed p) by (known_v_d H; repeat split; lra).
  by_law lugre_form sigma_1_at. by_damping H D.
Qed.
Theorem lugre_majorant_passive_damped p : lugre_majorant.allowed_v_d p -> damped p (excess_atan p) ->
  storage (U := R_UniformSpace) (lugre_majorant.dz_dt p) any (power_of (lugre_majorant.friction_v_d p)) any (lugre_majorant.stored_energy p).
Proof.
  intros H D. assert (H' : lugre_majorant.allowed p) by (known_v_d H; repeat split; lra).
  by_law lugre_majorant_form sigma_1_at. by_damping H D.
Qed.
Theorem lugre_majorant_sqrt_passive_damped p : lugre_majorant_sqrt.allowed_v_d p -> damped p (excess_sqrt p) ->
  storage (U := R_UniformSpace) (lugre_majorant_sqrt.dz_dt p) any (power_of (lugre_majorant_sqrt.friction_v_d p)) any (lugre_majorant_sqrt.stored_energy p).
Proof.
  intros H D. assert (H' : lugre_majorant_sqrt.allowed p) by (known_v_d H; repeat split; lra).
  by_law lugre_majorant_sqrt_form sigma_1_at. by_damping H D.
Qed.
Theorem lugre_majorant_compact_passive_damped p : lugre_majorant_compact.allowed_v_d p -> damped p (excess_compact p) ->
  storage (U := R_UniformSpace) (lugre_majorant_compact.dz_dt p) any (power_of (lugre_majorant_compact.friction_v_d p)) any (lugre_majorant_compact.stored_energy p).
Proof.
  intros H D. assert (H' : lugre_majorant_compact.allowed p) by (known_v_d H; repeat split; lra).
  by_law lugre_majorant_compact_form sigma_1_at. by_damping H D.
Qed.
Theorem elastoplastic_passive_damped p : elastoplastic.allowed_v_d p -> damped p (no_excess p) ->
  storage (U := R_UniformSpace) (elastoplastic.dz_dt p) any (power_of (elastoplastic.friction_v_d p)) any (elastoplastic.stored_energy p).
Proof.
  intros H D. assert (H' : elastoplastic.allowed p) by (known_v_d H; repeat split; lra).
  by_law elastoplastic_form sigma_1_at. by_damping H D.
Qed.
Theorem elastoplastic_majorant_passive_damped p : elastoplastic_majorant.allowed_v_d p -> damped p (excess_atan p) ->
  storage (U := R_UniformSpace) (elastoplastic_majorant.dz_dt p) any (power_of (elastoplastic_majorant.friction_v_d p)) any (elastoplastic_majorant.stored_energy p).
Proof.
  intros H D. assert (H' : elastoplastic_majorant.allowed p) by (known_v_d H; repeat split; lra).
  by_law elastoplastic_majorant_form sigma_1_at. by_damping H D.
Qed.
Theorem elastoplastic_majorant_sqrt_passive_damped p : elastoplastic_majorant_sqrt.allowed_v_d p -> damped p (excess_sqrt p) ->
  storage (U := R_UniformSpace) (elastoplastic_majorant_sqrt.dz_dt p) any (power_of (elastoplastic_majorant_sqrt.friction_v_d p)) any (elastoplastic_majorant_sqrt.stored_energy p).
Proof.
  intros H D. assert (H' : elastoplastic_majorant_sqrt.allowed p) by (known_v_d H; repeat split; lra).
  by_law elastoplastic_majorant_sqrt_form sigma_1_at. by_damping H D.
Qed.
Theorem elastoplastic_majorant_compact_passive_damped p : elastoplastic_majorant_compact.allowed_v_d p -> damped p (excess_compact p) ->
  storage (U := R_UniformSpace) (elastoplastic_majorant_compact.dz_dt p) any (power_of (elastoplastic_majorant_compact.friction_v_d p)) any (elastoplastic_majorant_compact.stored_energy p).
Proof.
  intros H D. assert (H' : elastoplastic_majorant_compact.allowed p) by (known_v_d H; repeat split; lra).
  by_law elastoplastic_majorant_compact_form sigma_1_at. by_damping H D.
Qed.

(* With v_d, the condition that the law claims: either of the two. *)

Theorem lugre_passive_v_d p : lugre.allowed_v_d p -> lugre.claims_passive_v_d p ->
  storage (U := R_UniformSpace) (lugre.dz_dt p) any (power_of (lugre.friction_v_d p)) (within (lugre.z_bound p)) (lugre.stored_energy p).
Proof.
  intros H C. assert (H' : lugre.allowed p) by (known_v_d H; repeat split; lra). destruct C as [HL | D].
  - by_law lugre_form sigma_1_at. unfold no_excess; lra.
  - apply storage_within with any; [intros; exact I|]. apply lugre_passive_damped; [exact H|]. unfold damped, no_excess. rewrite Rplus_0_r. exact D.
Qed.
Theorem lugre_majorant_passive_v_d p : lugre_majorant.allowed_v_d p -> lugre_majorant.claims_passive_v_d p ->
  storage (U := R_UniformSpace) (lugre_majorant.dz_dt p) any (power_of (lugre_majorant.friction_v_d p)) (within (lugre_majorant.z_bound p)) (lugre_majorant.stored_energy p).
Proof.
  intros H C. assert (H' : lugre_majorant.allowed p) by (known_v_d H; repeat split; lra). destruct C as [[HL Hm] | D].
  - by_law lugre_majorant_form sigma_1_at. 
  - apply storage_within with any; [intros; exact I|]. apply lugre_majorant_passive_damped; [exact H|]. exact D.
Qed.
Theorem lugre_majorant_sqrt_passive_v_d p : lugre_majorant_sqrt.allowed_v_d p -> lugre_majorant_sqrt.claims_passive_v_d p ->
  storage (U := R_UniformSpace) (lugre_majorant_sqrt.dz_dt p) any (power_of (lugre_majorant_sqrt.friction_v_d p)) (within (lugre_majorant_sqrt.z_bound p)) (lugre_majorant_sqrt.stored_energy p).
Proof.
  intros H C. assert (H' : lugre_majorant_sqrt.allowed p) by (known_v_d H; repeat split; lra). destruct C as [[HL Hm] | D].
  - by_law lugre_majorant_sqrt_form sigma_1_at. 
  - apply storage_within with any; [intros; exact I|]. apply lugre_majorant_sqrt_passive_damped; [exact H|]. exact D.
Qed.
Theorem lugre_majorant_compact_passive_v_d p : lugre_majorant_compact.allowed_v_d p -> lugre_majorant_compact.claims_passive_v_d p ->
  storage (U := R_UniformSpace) (lugre_majorant_compact.dz_dt p) any (power_of (lugre_majorant_compact.friction_v_d p)) (within (lugre_majorant_compact.z_bound p)) (lugre_majorant_compact.stored_energy p).
Proof.
  intros H C. assert (H' : lugre_majorant_compact.allowed p) by (known_v_d H; repeat split; lra). destruct C as [[HL Hm] | D].
  - by_law lugre_majorant_compact_form sigma_1_at. 
  - apply storage_within with any; [intros; exact I|]. apply lugre_majorant_compact_passive_damped; [exact H|]. exact D.
Qed.
Theorem elastoplastic_passive_v_d p : elastoplastic.allowed_v_d p -> elastoplastic.claims_passive_v_d p ->
  storage (U := R_UniformSpace) (elastoplastic.dz_dt p) any (power_of (elastoplastic.friction_v_d p)) (within (elastoplastic.z_bound p)) (elastoplastic.stored_energy p).
Proof.
  intros H C. assert (H' : elastoplastic.allowed p) by (known_v_d H; repeat split; lra). destruct C as [HL | D].
  - by_law elastoplastic_form sigma_1_at. unfold no_excess; lra.
  - apply storage_within with any; [intros; exact I|]. apply elastoplastic_passive_damped; [exact H|]. unfold damped, no_excess. rewrite Rplus_0_r. exact D.
Qed.
Theorem elastoplastic_majorant_passive_v_d p : elastoplastic_majorant.allowed_v_d p -> elastoplastic_majorant.claims_passive_v_d p ->
  storage (U := R_UniformSpace) (elastoplastic_majorant.dz_dt p) any (power_of (elastoplastic_majorant.friction_v_d p)) (within (elastoplastic_majorant.z_bound p)) (elastoplastic_majorant.stored_energy p).
Proof.
  intros H C. assert (H' : elastoplastic_majorant.allowed p) by (known_v_d H; repeat split; lra). destruct C as [[HL Hm] | D].
  - by_law elastoplastic_majorant_form sigma_1_at. 
  - apply storage_within with any; [intros; exact I|]. apply elastoplastic_majorant_passive_damped; [exact H|]. exact D.
Qed.
Theorem elastoplastic_majorant_sqrt_passive_v_d p : elastoplastic_majorant_sqrt.allowed_v_d p -> elastoplastic_majorant_sqrt.claims_passive_v_d p ->
  storage (U := R_UniformSpace) (elastoplastic_majorant_sqrt.dz_dt p) any (power_of (elastoplastic_majorant_sqrt.friction_v_d p)) (within (elastoplastic_majorant_sqrt.z_bound p)) (elastoplastic_majorant_sqrt.stored_energy p).
Proof.
  intros H C. assert (H' : elastoplastic_majorant_sqrt.allowed p) by (known_v_d H; repeat split; lra). destruct C as [[HL Hm] | D].
  - by_law elastoplastic_majorant_sqrt_form sigma_1_at. 
  - apply storage_within with any; [intros; exact I|]. apply elastoplastic_majorant_sqrt_passive_damped; [exact H|]. exact D.
Qed.
Theorem elastoplastic_majorant_compact_passive_v_d p : elastoplastic_majorant_compact.allowed_v_d p -> elastoplastic_majorant_compact.claims_passive_v_d p ->
  storage (U := R_UniformSpace) (elastoplastic_majorant_compact.dz_dt p) any (power_of (elastoplastic_majorant_compact.friction_v_d p)) (within (elastoplastic_majorant_compact.z_bound p)) (elastoplastic_majorant_compact.stored_energy p).
Proof.
  intros H C. assert (H' : elastoplastic_majorant_compact.allowed p) by (known_v_d H; repeat split; lra). destruct C as [[HL Hm] | D].
  - by_law elastoplastic_majorant_compact_form sigma_1_at. 
  - apply storage_within with any; [intros; exact I|]. apply elastoplastic_majorant_compact_passive_damped; [exact H|]. exact D.
Qed.

(* --- free of drift: dz/dt = v where |z| <= z_ba, and z goes as far as the body does ---------------------------------------- *)

Lemma elastic_motion (v z : R -> R) a b : motion (U := R_UniformSpace) (fun v _ => v) v z a b ->
  ex_RInt v a b /\ RInt v a b = z b - z a.
Proof.
  intros M. assert (Hc : continuous_2 (U := R_UniformSpace) (fun v _ => v)).
  { apply (c_fst (U := R_UniformSpace) (fun v : R => v)). intros w. apply continuous_id. }
  induction M as [a | a b c M [X1 I1] P]; [split; [apply ex_RInt_point|rewrite RInt_point; unfold zero; simpl; lra]|].
  destruct (piece_stores (U := R_UniformSpace) (fun v _ => v) (fun v _ => v) (fun x => x) (fun _ => 1) v z b c P Hc) as [X2 A].
  { intros x. auto_derive; [exact I|ring]. } { intros t _. lra. }
  assert (Hc' : continuous_2 (U := R_UniformSpace) (fun v (_ : R) => - v)) by (apply c_opp; exact Hc).
  destruct (piece_stores (U := R_UniformSpace) (fun v _ => v) (fun v _ => - v) (fun x => - x) (fun _ => - 1) v z b c P Hc')
    as [_ B].
  { intros x. auto_derive; [exact I|ring]. } { intros t _. lra. }
  rewrite (RInt_opp v) in B by exact X2. change (opp (RInt v b c)) with (- RInt v b c) in B.
  change (RInt (fun t => v t) b c) with (RInt v b c) in A.
  split; [apply (ex_RInt_Chasles v a b c); assumption|]. rewrite <- (RInt_Chasles v a b c) by assumption.
  change (plus (RInt v a b) (RInt v b c)) with (RInt v a b + RInt v b c). lra.
Qed.

Lemma elastic_within (dz : R -> R -> R) z0 (v z : R -> R) a b : (forall v z, Rabs z <= z0 -> dz v z = v) ->
  motion (U := R_UniformSpace) dz v z a b -> (forall t, a <= t <= b -> Rabs (z t) <= z0) ->
  motion (U := R_UniformSpace) (fun v _ => v) v z a b.
Proof.
  intros E M W. induction M as [a | a b c M IH P]; [apply at_once|]. assert (L := motion_le _ _ _ _ _ M).
  destruct P as [Hbc (u' & z' & Hu & Hz & Ez & Hd)]. apply onward with b; [apply IH; intros t Ht; apply W; lra|].
  split; [exact Hbc|]. exists u', z'. split; [exact Hu|]. split; [exact Hz|]. split; [exact Ez|].
  intros t Ht. destruct (Hd t Ht) as [D1 D2]. split; [exact D1|]. rewrite <- (E (v t) (z t)) by (apply W; lra). exact D2.
Qed.

Theorem elastoplastic_drift_free p v z : elastoplastic.allowed p -> Rabs z <= elastoplastic.z_elastic p -> elastoplastic.dz_dt p v z = v.
Proof.
  intros H Hz. unfold elastoplastic.dz_dt. rewrite alpha_elastic by exact Hz. unfold Rdiv. ring.
Qed.
Theorem elastoplastic_majorant_drift_free p v z : elastoplastic_majorant.allowed p -> Rabs z <= elastoplastic_majorant.z_elastic p -> elastoplastic_majorant.dz_dt p v z = v.
Proof.
  intros H Hz. unfold elastoplastic_majorant.dz_dt. rewrite a_elastic by (exact Hz || below_g). unfold Rdiv. ring.
Qed.
Theorem elastoplastic_majorant_sqrt_drift_free p v z : elastoplastic_majorant_sqrt.allowed p -> Rabs z <= elastoplastic_majorant_sqrt.z_elastic p -> elastoplastic_majorant_sqrt.dz_dt p v z = v.
Proof.
  intros H Hz. unfold elastoplastic_majorant_sqrt.dz_dt. rewrite a_elastic by (exact Hz || below_g). unfold Rdiv. ring.
Qed.
Theorem elastoplastic_majorant_compact_drift_free p v z : elastoplastic_majorant_compact.allowed p -> Rabs z <= elastoplastic_majorant_compact.z_elastic p -> elastoplastic_majorant_compact.dz_dt p v z = v.
Proof.
  intros H Hz. unfold elastoplastic_majorant_compact.dz_dt. rewrite a_elastic by (exact Hz || below_g). unfold Rdiv. ring.
Qed.

(* The deflection follows the body as long as it stays elastic: what is moved comes back. *)
Theorem elastoplastic_majorant_elastic p v z a b : elastoplastic_majorant.allowed p ->
  motion (U := R_UniformSpace) (elastoplastic_majorant.dz_dt p) v z a b ->
  (forall t, a <= t <= b -> Rabs (z t) <= elastoplastic_majorant.z_elastic p) -> RInt v a b = z b - z a.
Proof.
  intros H M W. apply elastic_motion. apply (elastic_within (elastoplastic_majorant.dz_dt p) (elastoplastic_majorant.z_elastic p)); auto.
  intros x y. apply elastoplastic_majorant_drift_free. exact H.
Qed.

(* --- dahl ---------------------------------------------------------------------------------------------------------------------- *)

Lemma c_dahl p : continuous_2 (U := R_UniformSpace) (dahl.dz_dt p).
Proof.
  unfold dahl.dz_dt. pose proof (c_fst (U := R_UniformSpace) (fun v : R => v) (fun w => continuous_id w)). cont.
Qed.

Lemma dahl_factor p : dahl.allowed p -> 0 < sigma_0 p /\ 0 < F_c p /\ 0 < F_c p / sigma_0 p /\
  sigma_0 p / F_c p * (F_c p / sigma_0 p) = 1 /\ 0 < sigma_0 p / F_c p.
Proof. intros [A B]. repeat split; auto; try (apply Rdiv_lt_0_compat; assumption). field. lra. Qed.

Theorem dahl_bounded p : dahl.allowed p -> keeps (U := R_UniformSpace) (dahl.dz_dt p) any (dahl.z_bound p).
Proof.
  intros H v z a b M _ Hz. destruct (dahl_factor p H) as (A & B & C & D & E).
  apply (motion_within (U := R_UniformSpace) (dahl.dz_dt p) any (dahl.z_bound p) v z a b M (fun _ _ => I) Hz);
  intros w x _ Hx; unfold dahl.z_bound, dahl.dz_dt in *; set (Z := F_c p / sigma_0 p) in *; set (k := sigma_0 p / F_c p) in *.
  - assert (1 <= k * x) by nra.
    replace (k * Rabs w * x) with (Rabs w * (k * x)) by ring. pose proof (Rle_abs w). pose proof (Rabs_pos w). nra.
  - assert (k * x <= - 1) by nra.
    replace (k * Rabs w * x) with (Rabs w * (k * x)) by ring.
    pose proof (Rcomplements.Rabs_maj2 w). pose proof (Rabs_pos w). nra.
Qed.

Theorem dahl_passive p : dahl.allowed p ->
  storage (U := R_UniformSpace) (dahl.dz_dt p) any (power_of (dahl.friction p)) any (dahl.stored_energy p).
Proof.
  intros H. destruct (dahl_factor p H) as (A & B & C & D & E).
  apply storage_by with (fun x => sigma_0 p * x).
  - intros; exact I.
  - unfold power_of, dahl.friction. pose proof (c_fst (U := R_UniformSpace) (fun v : R => v) (fun w => continuous_id w)). cont.
  - intros x. unfold dahl.stored_energy. auto_derive; [exact I|field].
  - intros x _. unfold dahl.stored_energy. pose proof (Rle_0_sqr x) as Q. unfold Rsqr in Q. nra.
  - intros w x _ _. unfold power_of, dahl.friction, dahl.dz_dt. set (k := sigma_0 p / F_c p) in *. pose proof (Rabs_pos w).
    assert (0 <= sigma_0 p * k * Rabs w * (x * x)).
    { apply Rmult_le_pos; [|apply Rle_0_sqr]. apply Rmult_le_pos; [nra|exact H0]. } nra.
Qed.
